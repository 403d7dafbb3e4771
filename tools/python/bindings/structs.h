#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.h"
#include "config/allowed.h"
#include "config/field.h"
#include "docs.h"

/// Structs of the library as classes of Python: keywords make one, its fields are attributes. Those of a
/// frozen one are only read, where it is the value of another's field: there a change would be lost.
namespace mallow::python {

enum class Change : std::uint8_t { frozen, live };

/// Live structs are seen as parts of what holds them, not copied.
template <class T>
inline constexpr bool k_live = false;

template <class T>
inline constexpr bool k_tuple = false;
template <class T>
inline constexpr bool k_tuple<std::vector<T>> = std::is_class_v<T> && !std::is_same_v<T, Vec3>;
template <>
inline constexpr bool k_tuple<std::vector<std::array<std::uint32_t, 3>>> = false;

/// `of`: whose value it is, for the message.
template <class M>
M convert(py::handle value, const std::string& of, const std::string& wanted) {
  const auto refuse = [&] {
    const std::string given = std::string(py::str(py::repr(value)));
    throw py::type_error(of + " must be " + wanted + ", not " + given.substr(0, 60));
  };
  try {
    return value.cast<M>();
  } catch (const py::cast_error&) {
    refuse();
  } catch (const py::error_already_set& error) {  // as what is to become a list and is none
    if (!error.matches(PyExc_TypeError)) throw;
    refuse();
  }
  throw py::cast_error();  // not reached
}

template <class T>
class Struct {
 public:
  struct Setting {
    std::string name;
    std::function<void(T&, py::handle)> set;
  };

  /// name: as in C++, which is where its doc is; `in` where it is nested or of a namespace.
  Struct(py::handle scope, const std::string& name, Change change, const std::string& in = "")
      : path_(in + name), change_(change), class_(scope, name.c_str(), doc(path_)) {}

  template <class Owner, class M>
  Struct& field(const std::string& name, M Owner::*member, std::string text = {},
                const std::string& wanted = wanted_text<M>()) {
    text += (text.empty() ? "" : "\n\n") + std::string(find_doc(name));
    const std::string of = path_ + "." + name;
    const auto set = [=](T& self, py::handle value) { self.*member = convert<M>(value, of, wanted); };
    if (change_ == Change::live)
      add(
          name, getter(member), [set](T& self, const py::object& value) { set(self, value); }, text);
    else
      add(name, getter(member), nullptr, text);
    settings().push_back({name, set});
    return *this;
  }
  /// All of its field table.
  Struct& table() {
    for_fields<T>([&](const auto& field) {
      using M = std::remove_reference_t<decltype(T{}.*field.member)>;
      std::string text = field.doc;
      if (*field.unit) text += std::string(" [") + field.unit + "]";
      const std::string wanted = allowed<M>(field.range);
      text += ": " + wanted + ".";
      if (field.left_out == k_required)
        text += " Required.";
      else if (*field.left_out)
        text += std::string(" None: ") + field.left_out + ".";
      else
        text += " Default: " + std::string(py::str(py::object(py::cast(T{}.*field.member)))) + ".";
      this->field(field.name, field.member, text, wanted);
    });
    return *this;
  }
  py::class_<T>& made() { return class_; }
  /// Its constructor, repr and replace().
  py::class_<T>& done() {
    const std::string path = path_;
    py::list names;
    for (const Setting& setting : settings()) names.append(setting.name);
    class_.attr("_fields") = py::tuple(names);
    class_.def(py::init([path](const py::args& args, const py::kwargs& kwargs) {
      T value{};
      fill(path, value, args, kwargs);
      return value;
    }));
    class_.def(
        "replace",
        [path](const T& self, const py::kwargs& changes) {
          T value = self;
          fill(path, value, py::args(), changes);
          return value;
        },
        "A copy with other values in some fields.");
    class_.def("__copy__", [](const T& self) { return T(self); });
    class_.def("__deepcopy__", [](const T& self, const py::object&) { return T(self); });
    class_.def("__repr__", [path](const py::object& self) {
      std::string text = path + "(";
      for (const Setting& setting : settings()) {
        if (&setting != &settings().front()) text += ", ";
        text += setting.name + "=" + std::string(py::str(py::repr(self.attr(setting.name.c_str()))));
      }
      return text + ")";
    });
    return class_;
  }

 private:
  static std::vector<Setting>& settings() {
    static std::vector<Setting> settings;
    return settings;
  }
  static void fill(const std::string& path, T& value, const py::args& args, const py::kwargs& kwargs) {
    const std::vector<Setting>& all = settings();
    if (args.size() > all.size())
      throw py::type_error(path + " has " + std::to_string(all.size()) + " fields, not " +
                           std::to_string(args.size()));
    for (std::size_t i = 0; i < args.size(); ++i) all[i].set(value, args[i]);
    for (const auto& [key, item] : kwargs) {
      const auto name = std::string(py::str(py::object(py::reinterpret_borrow<py::object>(key))));
      std::size_t i = 0;
      while (i < all.size() && all[i].name != name) ++i;
      if (i == all.size()) throw py::type_error(path + " has no field " + name);
      if (i < args.size()) throw py::type_error(path + ": " + name + " is given twice");
      all[i].set(value, item);
    }
  }
  template <class M>
  static std::string wanted_text() {
    if constexpr (std::is_same_v<M, bool>)
      return "True or False";
    else if constexpr (std::is_integral_v<M>)
      return "a whole number";
    else if constexpr (std::is_floating_point_v<M>)
      return "a number";
    else
      return "what its doc says";
  }
  template <class Owner, class M>
  static auto getter(M Owner::*member) {
    if constexpr (k_live<M>)
      return [member](T& self) -> M& { return self.*member; };
    else if constexpr (k_tuple<M>)
      return [member](const T& self) { return Tuple<typename M::value_type>{self.*member}; };
    else
      return [member](const T& self) -> M { return self.*member; };
  }
  template <class Get, class Set>
  void add(const std::string& name, const Get& get, const Set& set, const std::string& text) {
    const std::string field_doc = text;
    if constexpr (std::is_same_v<Set, std::nullptr_t>)
      class_.def_property_readonly(name.c_str(), get, field_doc.c_str());
    else
      class_.def_property(name.c_str(), get, set, field_doc.c_str());
  }
  const char* find_doc(const std::string& name) const {
    for (const std::string& owner : {path_, base_})
      if (!owner.empty())
        for (const Doc& entry : docs())
          if (entry.name == owner + "." + name) return entry.text;
    throw std::logic_error("no header has a field " + path_ + "." + name);
  }

 public:
  /// Whose fields it has too.
  Struct& derived(const std::string& base) {
    base_ = base;
    return *this;
  }

 private:
  std::string path_;
  std::string base_;
  Change change_;
  py::class_<T> class_;
};

/// A choice of the library: "jelly" stands for Finish.jelly.
template <class E>
py::enum_<E> choice(py::handle scope, const char* name,
                    std::initializer_list<std::pair<const char*, E>> values, const std::string& in = "") {
  const std::string path = in + name;
  py::enum_<E> bound(scope, name, doc(path));
  std::string names;
  for (const auto& [word, value] : values) {
    bound.value(word, value, doc(path + "." + word));
    names += (names.empty() ? "\"" : ", \"") + std::string(word) + "\"";
  }
  const std::vector<std::pair<const char*, E>> known(values);
  bound.def(py::init([known, path, names](const std::string& word) {
              for (const auto& [name_of, value] : known)
                if (word == name_of) return value;
              throw py::value_error(path + " is one of " + names + ", not \"" + word + "\"");
            }),
            py::arg("name"));
  py::implicitly_convertible<py::str, E>();
  return bound;
}

}  // namespace mallow::python
