#include "scene/field_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "files/nearest_name.h"
#include "scene/scene_fields.h"

namespace mallow::scene_file {
namespace {

/// Reads one node into the target of one field; a problem leaves the target as it is.
class ValueReader {
 public:
  ValueReader(const Node& node, std::string path, const BoundField& field, Problems& problems)
      : node_(node), path_(std::move(path)), field_(field), problems_(problems) {}

  void operator()(bool* flag) const {
    if (const bool* given = node_.get_if<bool>())
      *flag = *given;
    else
      complain();
  }

  void operator()(int* number) const {
    const std::int64_t* given = node_.get_if<std::int64_t>();
    if (given && field_.range.holds(*given) && *given <= std::numeric_limits<int>::max() &&
        *given >= std::numeric_limits<int>::min())
      *number = static_cast<int>(*given);
    else
      complain();
  }

  bool operator()(double* number) const {
    double given = 0;
    if (const std::int64_t* whole = node_.get_if<std::int64_t>())
      given = static_cast<double>(*whole);
    else if (const double* real = node_.get_if<double>())
      given = *real;
    else
      return complain(), false;
    if (!std::isfinite(given) || !field_.range.holds(given)) return complain(), false;
    *number = given;
    return true;
  }

  void operator()(float* number) const {
    double given = 0;
    if (!(*this)(&given)) return;
    const float rounded = static_cast<float>(given);
    if (std::isinf(rounded))
      return complain("a number of single precision, at most " +
                      number_text(std::numeric_limits<float>::max()));
    if (field_.range.above_lowest && rounded <= static_cast<float>(field_.range.lowest))
      return complain("a number of single precision, at least " +
                      number_text(std::numeric_limits<float>::denorm_min()));
    *number = rounded;
  }

  void operator()(Vec3* vector) const {
    if (const auto read = read_three<float>()) *vector = Vec3(read->data());
  }

  void operator()(std::vector<Vec3>* points) const {
    const Array* given = node_.get_if<Array>();
    if (!given || given->empty()) return complain();
    std::vector<Vec3> read(given->size());
    const std::size_t problems_before = problems_.count();
    for (std::size_t i = 0; i < read.size(); ++i)
      read_number((*given)[i], element_path(path_, i), field_.range, &read[i]);
    if (problems_.count() == problems_before) *points = std::move(read);
  }

  void operator()(Count3* count) const {
    if (const auto read = read_three<int>()) *count = *read;
  }

  void operator()(std::string* text) const {
    const std::string* given = node_.get_if<std::string>();
    if (!given) return complain();
    if (given->empty() && field_.required()) return complain(allowed(field_) + " that is not empty");
    // Control characters garble every message they get into, but a file may have them in its name; only a
    // zero byte would cut that short.
    const bool is_path = std::holds_alternative<std::filesystem::path*>(field_.target);
    if (is_path && given->find('\0') != given->npos)
      return complain(allowed(field_) + " without a zero byte");
    if (!is_path && std::any_of(given->begin(), given->end(),
                                [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
      return complain(allowed(field_) + " without control characters");
    const std::size_t most = is_path ? k_max_path_bytes : k_max_name_bytes;
    if (given->size() > most)
      return complain(allowed(field_) + " of at most " + std::to_string(most) + " bytes");
    *text = *given;
  }

  void operator()(std::filesystem::path* path) const {
    std::string text;
    (*this)(&text);
    if (!text.empty()) *path = text;
  }

  /// Of instruction levels any that there is: a scene may have been written for another machine.
  template <Choice T>
  void operator()(T* choice) const {
    const std::string* given = node_.get_if<std::string>();
    const auto names = choices(T{});
    const auto name = given ? std::find(names.begin(), names.end(), *given) : names.end();
    if (name == names.end()) return complain();
    *choice = static_cast<T>(name - names.begin());
  }

  void operator()(Schedule* schedule) const {
    const Array* keyframes = node_.get_if<Array>();
    const std::size_t problems_before = problems_.count();
    if (!keyframes) {
      float constant = 0;
      if (!node_.get_if<double>() && !node_.get_if<std::int64_t>()) return complain();
      read_number(node_, path_, field_.range, &constant);
      if (problems_.count() == problems_before) *schedule = Schedule(constant);
      return;
    }
    if (keyframes->empty()) return complain();
    std::vector<ScheduleKey> keys;
    for (std::size_t i = 0; i < keyframes->size(); ++i) keys.push_back(read_keyframe((*keyframes)[i], i));
    if (problems_.count() != problems_before) return;
    for (std::size_t i = 1; i < keys.size(); ++i)
      if (keys[i].time <= keys[i - 1].time)
        problems_.add((*keyframes)[i].place, element_path(path_, i),
                      not_allowed(key_of_schedule(field_) + ' ' + number_text(keys[i].time),
                                  "a " + key_of_schedule(field_) +
                                      (key_of_schedule(field_) == "time" ? " after " : " above ") +
                                      number_text(keys[i - 1].time) + ", that of the key before"));
    if (problems_.count() == problems_before) *schedule = Schedule(std::move(keys));
  }

  template <class T>
  void operator()(std::optional<T>* value) const {
    const std::size_t problems_before = problems_.count();
    T read{};
    (*this)(&read);
    if (problems_.count() == problems_before) *value = read;
  }

 private:
  void complain() const { complain(allowed(field_)); }
  void complain(const std::string& allowed) const {
    problems_.add(node_.place, path_, not_allowed(describe(node_), allowed));
  }

  template <class Number>
  void read_number(const Node& node, const std::string& path, const Range& range, Number* number) const {
    const BoundField field{field_.name, number, range, field_.unit, field_.doc};
    ValueReader(node, path, field, problems_)(number);
  }

  template <class Number>
  std::optional<std::array<Number, 3>> read_three() const {
    const Array* given = node_.get_if<Array>();
    if (!given || given->size() != 3) {
      complain();
      return std::nullopt;
    }
    const std::size_t problems_before = problems_.count();
    std::array<Number, 3> numbers{};
    for (std::size_t i = 0; i < 3; ++i)
      read_number((*given)[i], element_path(path_, i), field_.range, &numbers[i]);
    return problems_.count() == problems_before ? std::optional(numbers) : std::nullopt;
  }

  ScheduleKey read_keyframe(const Node& node, std::size_t index) const {
    ScheduleKey key{};
    const std::string path = element_path(path_, index);
    const Array* pair = node.get_if<Array>();
    if (!pair || pair->size() != 2) {
      problems_.add(node.place, path,
                    not_allowed(describe(node), "two numbers [" + key_of_schedule(field_) + ", number]"));
      return key;
    }
    read_number((*pair)[0], element_path(path, 0), k_finite, &key.time);
    read_number((*pair)[1], element_path(path, 1), field_.range, &key.value);
    return key;
  }

  const Node& node_;
  std::string path_;
  const BoundField& field_;
  Problems& problems_;
};

}  // namespace

std::string join_path(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + '.' + key;
}

std::string element_path(const std::string& path, std::size_t index) {
  return path + '[' + std::to_string(index) + ']';
}

std::string not_allowed(const std::string& given, const std::string& allowed) {
  return given + " is not allowed: " + allowed;
}

void read_fields(const Node& table, const std::string& path, const BoundFields& fields,
                 std::span<const std::string> also, Problems& problems) {
  std::vector<std::string> known(also.begin(), also.end());
  for (const BoundField& field : fields) known.push_back(field.name);

  const Table* entries = table.get_if<Table>();
  if (!entries) {
    problems.add(table.place, path, not_allowed(describe(table), "a table"));
    return;
  }
  for (const Entry& entry : *entries) {
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&](const BoundField& f) { return entry.key == f.name; });
    if (field != fields.end())
      std::visit(ValueReader(entry.node, join_path(path, entry.key), *field, problems), field->target);
    else if (std::find(also.begin(), also.end(), entry.key) == also.end())
      problems.add(entry.place, path,
                   "unknown key '" + entry.key + "'" + (problems.full() ? "" : suggestion(entry.key, known)));
  }
  for (const BoundField& field : fields)
    if (field.required() && !find(table, field.name))
      problems.add(table.place, join_path(path, field.name), "is missing: " + allowed(field));
}

}  // namespace mallow::scene_file
