#pragma once

#include <core/Timing.hpp>
#include <lib/multimethods/FunctorWrapper.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

/// What a dispatcher calls for the classes of objects it accepts.
class Functor : public Serializable {
	YADE_ABI_CLASS(Functor)
	Functor() = default;
	virtual vector<string> getFunctorTypes() const;

	shared_ptr<TimingDeltas> timingDeltas;
	Scene* scene = nullptr; // set by the dispatcher before each loop
	string label;
};

template <class Dispatched, class Result, class ArgList>
class Functor1D : public Functor, public FunctorWrapper<Result, ArgList> {
public:
	using DispatchType1 = Dispatched;
	Functor1D() {}
	~Functor1D() override {}
	string getBaseClassName(unsigned i = 0) const override;
	int getBaseClassNumber() const override;
	string getClassName() const override;
	vector<string> getFunctorTypes() const override;
	virtual string get1DFunctorType1() const;
};

template <class Dispatched1, class Dispatched2, class Result, class ArgList>
class Functor2D : public Functor, public FunctorWrapper<Result, ArgList> {
public:
	using DispatchType1 = Dispatched1;
	using DispatchType2 = Dispatched2;
	Functor2D() {}
	~Functor2D() override {}
	string getBaseClassName(unsigned i = 0) const override;
	int getBaseClassNumber() const override;
	string getClassName() const override;
	vector<string> getFunctorTypes() const override;
	virtual string get2DFunctorType1() const;
	virtual string get2DFunctorType2() const;
};

} // namespace yade

/// The classes that a plugin functor accepts; stands in its body. They must be defined, as YADE's own macros cast to them.
#define FUNCTOR1D(A)                                                                                                                       \
public:                                                                                                                                    \
	string get1DFunctorType1() const override                                                                                              \
	{                                                                                                                                      \
		static_assert(sizeof(A), "include the header of " #A);                                                                             \
		return #A;                                                                                                                         \
	}
#define FUNCTOR2D(A, B)                                                                                                                    \
public:                                                                                                                                    \
	string get2DFunctorType1() const override                                                                                              \
	{                                                                                                                                      \
		static_assert(sizeof(A), "include the header of " #A);                                                                             \
		return #A;                                                                                                                         \
	}                                                                                                                                      \
	string get2DFunctorType2() const override                                                                                              \
	{                                                                                                                                      \
		static_assert(sizeof(B), "include the header of " #B);                                                                             \
		return #B;                                                                                                                         \
	}

YADE_ABI_ARCHIVED(Functor)
