#pragma once
// Archives that write the state of a run as a row of numbers, and read it back.
//
// Classes whose state is saved have a member serialize(archive), which calls archive(...) with the members that a continued run needs: one
// list for saving and loading, as in cereal. Numbers, enumerations, Eigen's matrices, lanes, vectors and arrays of such, and classes with
// serialize() can be members.
#include <Eigen/Core>
#include <array>
#include <boost/container/small_vector.hpp>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace masonry {

// Goes down to numbers: Archive::number(value) writes a double, or sets it.
template <class Archive>
class NumberArchive {
public:
	template <class... T>
	void operator()(T&&... members)
	{
		(member(members), ...);
	}

private:
	template <class T, class Allocator>
	void member(std::vector<T, Allocator>& list)
	{
		sized(list);
	}
	template <class T, size_t usual>
	void member(boost::container::small_vector<T, usual>& list)
	{
		sized(list);
	}
	template <class List>
	void sized(List& list)
	{
		double size = double(list.size());
		self().number(size);
		if (!(size >= 0 && size < double(list.max_size())))
			throw std::length_error("size of a list");
		list.resize(size_t(size));
		for (auto& one : list)
			member(one);
	}
	template <class T, size_t size>
	void member(std::array<T, size>& list)
	{
		for (T& one : list)
			member(one);
	}
	template <class T>
	void member(T& value)
	{
		if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
			double number = double(value);
			self().number(number);
			value = T(number);
		} else if constexpr (std::is_base_of_v<Eigen::EigenBase<T>, T>) {
			for (int i = 0; i < value.size(); ++i)
				self().number(value(i));
		} else if constexpr (std::is_class_v<T>) {
			value.serialize(self());
		} else { // lanes
			for (size_t i = 0; i < sizeof(T) / sizeof(double); ++i) {
				double number = value[i];
				self().number(number);
				value[i] = number;
			}
		}
	}
	Archive& self() { return static_cast<Archive&>(*this); }
};

class NumberWriter : public NumberArchive<NumberWriter> {
public:
	void number(double value) { numbers.push_back(value); }
	std::vector<double> numbers;
};

// Throws an exception of the standard library for a row that its members have not written: one that ends too early, or with a size that no
// list can have.
class NumberReader : public NumberArchive<NumberReader> {
public:
	explicit NumberReader(const std::vector<double>& row) : numbers(row) {}
	void number(double& value) { value = numbers.at(next++); }
	bool isAtEnd() const { return next == numbers.size(); }

private:
	const std::vector<double>& numbers;
	size_t next {0};
};

} // namespace masonry
