#pragma once
// NumPy arrays in and out, the GIL, and a loop over independent cases on all cores.

#include <algorithm>
#include <boost/python.hpp>
#include <boost/python/numpy.hpp>
#include <cstring>
#include <exception>
#include <limits>
#include <mutex>
#include <vector>

namespace masonry::python {

namespace py = boost::python;
namespace np = boost::python::numpy;

// A copy of a one-dimensional array (other dtypes are converted).
template <typename T = double>
std::vector<T> toVector(const py::object& object)
{
	const np::ndarray array = np::from_object(object, np::dtype::get_builtin<T>(), 1, 1, np::ndarray::CARRAY);
	const auto* data = reinterpret_cast<const T*>(array.get_data());
	return {data, data + array.shape(0)};
}

// An array of that shape; without it, of one dimension.
template <typename T>
np::ndarray toArray(const std::vector<T>& values, const py::tuple& shape = {})
{
	np::ndarray array = np::empty(py::len(shape) ? shape : py::make_tuple(values.size()), np::dtype::get_builtin<T>());
	if (!values.empty())
		std::memcpy(array.get_data(), values.data(), values.size() * sizeof(T));
	return array;
}

// One row a case, short rows filled with NaN.
inline np::ndarray toTable(const std::vector<std::vector<double>>& rows)
{
	size_t columns = 0;
	for (const auto& row : rows)
		columns = std::max(columns, row.size());
	np::ndarray table = np::empty(py::make_tuple(rows.size(), columns), np::dtype::get_builtin<double>());
	auto* data = reinterpret_cast<double*>(table.get_data());
	std::fill(data, data + rows.size() * columns, std::numeric_limits<double>::quiet_NaN());
	for (size_t i = 0; i < rows.size(); i++)
		std::copy(rows[i].begin(), rows[i].end(), data + i * columns);
	return table;
}

class WithoutGil {
public:
	WithoutGil() : thread_(PyEval_SaveThread()) {}
	~WithoutGil() { PyEval_RestoreThread(thread_); }
	WithoutGil(const WithoutGil&) = delete;
	WithoutGil& operator=(const WithoutGil&) = delete;

private:
	PyThreadState* thread_;
};

// body(i) for every case, without the GIL, in any order on all cores: it may write to place i of its results only. If cases
// fail, the exception of the first of them is thrown.
template <typename Body>
void forEachCase(size_t cases, const Body& body)
{
	std::exception_ptr failure;
	size_t failed = cases;
	std::mutex mutex;
	{
		WithoutGil nogil;
		const int together = int(std::clamp<size_t>(cases / 64, 1, 16)); // few cases are long ones: they are dealt out singly
#pragma omp parallel for schedule(dynamic, together) if (cases > 16)
		for (size_t i = 0; i < cases; i++) {
			try {
				body(i);
			} catch (...) {
				const std::lock_guard<std::mutex> lock(mutex);
				if (i < failed) {
					failed = i;
					failure = std::current_exception();
				}
			}
		}
	}
	if (failure)
		std::rethrow_exception(failure);
}

} // namespace masonry::python
