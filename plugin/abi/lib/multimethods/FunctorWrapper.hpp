// The second base of every functor: one `go` and one `goReverse` for each number of arguments from 1 to 7. A family
// uses the one with as many arguments as its list has; places past the end of the list have type boost::mpl::void_,
// which keeps the overloads apart.
#pragma once

#include <boost/mpl/at.hpp>
#include <boost/mpl/vector.hpp>
#include <string>

namespace yade {

template <class Result, class ArgList>
class FunctorWrapper {
	template <int I>
	using Arg = typename boost::mpl::at_c<ArgList, I>::type;

public:
	using A1 = Arg<0>;
	using A2 = Arg<1>;
	using A3 = Arg<2>;
	using A4 = Arg<3>;
	using A5 = Arg<4>;
	using A6 = Arg<5>;
	using A7 = Arg<6>;

	FunctorWrapper() {}
	virtual ~FunctorWrapper() {}
	virtual std::string checkOrder() const;
	virtual Result go(A1);
	virtual Result go(A1, A2);
	virtual Result go(A1, A2, A3);
	virtual Result go(A1, A2, A3, A4);
	virtual Result go(A1, A2, A3, A4, A5);
	virtual Result go(A1, A2, A3, A4, A5, A6);
	virtual Result go(A1, A2, A3, A4, A5, A6, A7);
	virtual Result goReverse(A1);
	virtual Result goReverse(A1, A2);
	virtual Result goReverse(A1, A2, A3);
	virtual Result goReverse(A1, A2, A3, A4);
	virtual Result goReverse(A1, A2, A3, A4, A5);
	virtual Result goReverse(A1, A2, A3, A4, A5, A6);
	virtual Result goReverse(A1, A2, A3, A4, A5, A6, A7);
};

} // namespace yade

/// What an Ig2 functor must answer: the order of the two shapes in which go() takes them.
#define DEFINE_FUNCTOR_ORDER_2D(A, B)                                                                                                      \
public:                                                                                                                                    \
	std::string checkOrder() const override { return #A " " #B; }
