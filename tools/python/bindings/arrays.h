#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/column_memory.h"
#include "mallow/simulation.h"
#include "mallow/vec3.h"

/// Arrays of NumPy: what goes in is checked and copied, what comes out is a copy, or a view that keeps what
/// it shows.
namespace mallow::python {
namespace py = pybind11;

/// Takes the right to write away.
inline py::array sealed(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// An array over memory that `keeper` keeps, without a copy.
template <class Scalar>
py::array view_of(const Scalar* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                  std::shared_ptr<const void> keeper) {
  using Keeper = std::shared_ptr<const void>;
  auto held = std::make_unique<Keeper>(std::move(keeper));
  const py::capsule owner(held.get(), [](void* kept) { delete static_cast<Keeper*>(kept); });
  held.release();
  return {py::dtype::of<Scalar>(), std::move(shape), std::move(strides), data, owner};
}

/// A column of a simulation, to read. Its memory stays while the view lives: see keep_column().
template <class Scalar>
py::array column_view(std::span<const Scalar> column) {
  if (column.empty()) return sealed(py::array_t<Scalar>(0));
  return sealed(view_of(column.data(), {static_cast<py::ssize_t>(column.size())}, {sizeof(Scalar)},
                        keep_column(column.data())));
}
/// Three columns as n × 3.
template <class Scalar>
py::array column_view(const VectorColumns<Scalar>& columns) {
  if (columns.size() == 0) return sealed(py::array_t<float>(std::vector<py::ssize_t>{0, 3}));
  const float* const x = columns.x().data();
  const py::ssize_t stride = columns.y().data() - x;
  py::array array =
      view_of(x, {static_cast<py::ssize_t>(columns.size()), 3},
              {sizeof(float), stride * static_cast<py::ssize_t>(sizeof(float))}, keep_column(x));
  return std::is_const_v<Scalar> ? sealed(array) : array;
}

/// Why an array cannot be taken; TypeError and ValueError of Python.
[[noreturn]] inline void refuse_shape(const py::array& array, const std::string& wanted) {
  throw py::value_error("an array of shape " + py::str(array.attr("shape")).cast<std::string>() +
                        " is not allowed here: it must be " + wanted);
}
[[noreturn]] inline void refuse_type(const py::array& array, const std::string& wanted) {
  throw py::type_error("an array of dtype " + py::str(array.dtype()).cast<std::string>() +
                       " is not allowed here: it must hold " + wanted);
}

/// The array that an argument is or stands for; empty where it is none that could hold numbers.
template <class Scalar>
std::optional<py::array> numbers_of(py::handle source) {
  if (!source || source.is_none() || PyUnicode_Check(source.ptr()) || PyBytes_Check(source.ptr())) return {};
  const bool is_array = py::isinstance<py::array>(source);
  if (!is_array && !PySequence_Check(source.ptr())) return {};
  py::array array = py::array::ensure(source);
  if (!array) {
    PyErr_Clear();
    return {};
  }
  const char kind = array.dtype().kind();
  const bool is_whole = kind == 'i' || kind == 'u';
  const bool fits =
      std::is_floating_point_v<Scalar> ? is_whole || kind == 'f' : is_whole || array.size() == 0;
  if (!fits) {
    if (is_array) refuse_type(array, std::is_floating_point_v<Scalar> ? "real numbers" : "whole numbers");
    return {};
  }
  if constexpr (std::is_unsigned_v<Scalar>)
    if (array.size() > 0 && (kind == 'i' || sizeof(Scalar) < 8)) {
      const auto least = array.attr("min")(), most = array.attr("max")();
      if (least.attr("__lt__")(0).template cast<bool>() ||
          most.attr("__gt__")(std::numeric_limits<Scalar>::max()).template cast<bool>())
        throw py::value_error("whole numbers from 0 to " +
                              std::to_string(std::numeric_limits<Scalar>::max()) + " are allowed here");
    }
  return array;
}

/// Copies rows of `columns` numbers out of an array: n, or n × columns where there are several.
template <class T, class Scalar>
bool load_rows(py::handle source, std::size_t columns, std::vector<T>& rows) {
  static_assert(sizeof(T) % sizeof(Scalar) == 0);
  const std::optional<py::array> array = numbers_of<Scalar>(source);
  if (!array) return false;
  const bool is_flat = columns == 1;
  if (array->size() == 0 && array->ndim() <= 2) {
    rows.clear();
    return true;
  }
  if (is_flat ? array->ndim() != 1
              : array->ndim() != 2 || array->shape(1) != static_cast<py::ssize_t>(columns)) {
    if (py::isinstance<py::array>(source))
      refuse_shape(*array, is_flat ? "of one dimension" : "n x " + std::to_string(columns));
    return false;
  }
  const auto plain = py::array_t<Scalar, py::array::c_style | py::array::forcecast>::ensure(*array);
  if (!plain) throw py::error_already_set();
  rows.resize(static_cast<std::size_t>(plain.shape(0)));
  std::memcpy(static_cast<void*>(rows.data()), plain.data(), rows.size() * sizeof(T));
  return true;
}

/// Rows as an array of their own, without a copy.
template <class T, class Scalar>
py::array rows_array(std::vector<T>&& rows, std::size_t columns) {
  auto held = std::make_shared<const std::vector<T>>(std::move(rows));
  const auto count = static_cast<py::ssize_t>(held->size());
  std::vector<py::ssize_t> shape{count}, strides{sizeof(T)};
  if (columns > 1) {
    shape.push_back(static_cast<py::ssize_t>(columns));
    strides.push_back(sizeof(Scalar));
  }
  if (count == 0) return py::array(py::dtype::of<Scalar>(), shape);
  return view_of(reinterpret_cast<const Scalar*>(held->data()), shape, strides, held);
}

/// Columns of configs come out as copies that cannot be written: who means to change one gives it anew.
inline py::handle out(py::array array, py::return_value_policy policy) {
  return (policy == py::return_value_policy::reference_internal ? sealed(std::move(array)) : std::move(array))
      .release();
}

/// Structs of a list, as a tuple: one that was changed would change nothing.
template <class T>
struct Tuple {
  std::vector<T> items;
};

}  // namespace mallow::python

namespace pybind11::detail {

/// A vector of N numbers: any sequence of them in, an array that cannot be written out.
template <class Vector, class Scalar, std::size_t N>
struct small_vector_caster {
  static constexpr auto name = const_name<N == 4>("Quaternion", "Vector");
  bool load(handle source, bool) {
    const auto array = mallow::python::numbers_of<Scalar>(source);
    if (!array) return false;
    if (array->ndim() != 1 || array->shape(0) != static_cast<ssize_t>(N)) {
      if (isinstance<pybind11::array>(source))
        mallow::python::refuse_shape(*array, std::to_string(N) + " numbers");
      return false;
    }
    const auto plain = array_t<Scalar, pybind11::array::c_style | pybind11::array::forcecast>::ensure(*array);
    if (!plain) throw error_already_set();
    std::memcpy(static_cast<void*>(value.data()), plain.data(), N * sizeof(Scalar));
    return true;
  }
  static handle cast(const Vector& vector, return_value_policy, handle) {
    return mallow::python::sealed(array_t<Scalar>(static_cast<ssize_t>(N), vector.data())).release();
  }
  template <class>
  using cast_op_type = const Vector&;
  operator const Vector&() { return value; }  // NOLINT: what pybind11 asks for

 private:
  Vector value{};
};
template <>
struct type_caster<mallow::Vec3> : small_vector_caster<mallow::Vec3, float, 3> {};
template <>
struct type_caster<Eigen::Vector3d> : small_vector_caster<Eigen::Vector3d, double, 3> {};
template <>
struct type_caster<Eigen::Vector4d> : small_vector_caster<Eigen::Vector4d, double, 4> {};
template <>
struct type_caster<std::array<int, 3>> : small_vector_caster<std::array<int, 3>, int, 3> {};

template <class T, class Scalar, std::size_t Columns>
struct rows_caster {
  PYBIND11_TYPE_CASTER(std::vector<T>, const_name("numpy.ndarray"));
  bool load(handle source, bool) { return mallow::python::load_rows<T, Scalar>(source, Columns, value); }
  static handle cast(std::vector<T> rows, return_value_policy policy, handle) {
    return mallow::python::out(mallow::python::rows_array<T, Scalar>(std::move(rows), Columns), policy);
  }
};
template <>
struct type_caster<std::vector<mallow::Vec3>> : rows_caster<mallow::Vec3, float, 3> {};
template <>
struct type_caster<std::vector<float>> : rows_caster<float, float, 1> {};
template <>
struct type_caster<std::vector<std::uint32_t>> : rows_caster<std::uint32_t, std::uint32_t, 1> {};
template <>
struct type_caster<std::vector<std::uint64_t>> : rows_caster<std::uint64_t, std::uint64_t, 1> {};
template <>
struct type_caster<std::vector<std::array<std::uint32_t, 3>>>
    : rows_caster<std::array<std::uint32_t, 3>, std::uint32_t, 3> {};
template <>
struct type_caster<std::vector<std::array<float, 4>>> : rows_caster<std::array<float, 4>, float, 4> {};

template <class T>
struct type_caster<mallow::python::Tuple<T>> {
  using Items = mallow::python::Tuple<T>;
  PYBIND11_TYPE_CASTER(Items, const_name("Tuple[") + make_caster<T>::name + const_name(", ...]"));
  static handle cast(Items items, return_value_policy, handle) {
    tuple result(items.items.size());
    for (std::size_t i = 0; i < items.items.size(); ++i)
      result[i] = pybind11::cast(std::move(items.items[i]));
    return result.release();
  }
};

}  // namespace pybind11::detail
