#include "errors.h"

#include "mallow/errors.h"
#include "parts.h"
#include "structs.h"

namespace mallow::python {
namespace {

/// The classes of exceptions, which live as long as the process.
struct Exceptions {
  py::object error, config, io, step, busy;
};
Exceptions& exceptions() {
  static Exceptions& all = *new Exceptions;
  return all;
}

py::object make_exception(py::module_& module, const char* name, const char* text, const py::object& bases) {
  const std::string full = std::string("mallow.") + name;
  PyObject* const made = PyErr_NewExceptionWithDoc(full.c_str(), text, bases.ptr(), nullptr);
  if (!made) throw py::error_already_set();
  module.attr(name) = py::reinterpret_steal<py::object>(made);
  return module.attr(name);
}

/// Names of files may be any bytes: a message must not fail by them.
py::str text(std::string_view bytes) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "replace"));
}

/// What all tell of the first of their problems.
void tell(const py::object& exception, const Problem& problem) {
  exception.attr("file") = text(problem.file);
  exception.attr("line") = problem.line;
  exception.attr("column") = problem.column;
  exception.attr("field") = text(problem.field);
}

void raise(const py::object& exception) {
  PyErr_SetObject(py::type::of(exception).ptr(), exception.ptr());
}

void translate(std::exception_ptr thrown) {
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const ConfigError& error) {
    const py::object exception = exceptions().config(text(error.what()));
    exception.attr("problems") = py::tuple(py::cast(error.problems()));
    tell(exception, error.problems().front());
    raise(exception);
  } catch (const IoError& error) {
    const py::object exception = exceptions().io(text(error.what()));
    exception.attr("problem") = error.problem();
    exception.attr("problems") = py::make_tuple(error.problem());
    tell(exception, error.problem());
    raise(exception);
  } catch (const StepError& error) {
    const py::object exception = exceptions().step(text(error.what()));
    exception.attr("particle_id") = error.particle_id();
    exception.attr("phase") = error.phase();
    raise(exception);
  } catch (const Error& error) {
    raise(exceptions().error(text(error.what())));
  } catch (const BusyError& error) {
    raise(exceptions().busy(text(error.what())));
  }
}

}  // namespace

void bind_errors(py::module_& module) {
  Struct<Problem>(module, "Problem", Change::frozen)
      .field("file", &Problem::file)
      .field("line", &Problem::line)
      .field("column", &Problem::column)
      .field("field", &Problem::field)
      .field("message", &Problem::message)
      .done()
      .def("__str__", [](const Problem& problem) { return to_string(problem); });
  module.def("to_string", &to_string, py::arg("problem"), doc("to_string"));

  Exceptions& all = exceptions();
  const auto builtin = [](PyObject* type) { return py::reinterpret_borrow<py::object>(type); };
  all.error = make_exception(module, "Error", doc("Error"), builtin(PyExc_RuntimeError));
  all.config = make_exception(module, "ConfigError", doc("ConfigError"),
                              py::make_tuple(all.error, builtin(PyExc_ValueError)));
  all.io = make_exception(module, "IoError", doc("IoError"), all.error);
  all.step = make_exception(module, "StepError", doc("StepError"), all.error);
  all.busy =
      make_exception(module, "BusyError",
                     "An object is in use by another thread, or by the call that a callback came from: one "
                     "thread may use an object at a time. The other thread is not disturbed.",
                     all.error);
  for (const py::object& type : {all.config, all.io}) {
    type.attr("problems") = py::tuple();
    tell(type, Problem{});
  }
  all.io.attr("problem") = py::none();
  all.step.attr("particle_id") = py::none();
  all.step.attr("phase") = py::none();
  py::register_exception_translator(&translate);
}

}  // namespace mallow::python
