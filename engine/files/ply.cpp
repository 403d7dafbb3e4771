#include "files/ply.h"

#include <cmath>
#include <limits>

#include "files/byte_writer.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

template <class T>
bool holds(double value) {
  return value == std::floor(value) && value >= static_cast<double>(std::numeric_limits<T>::min()) &&
         value <= static_cast<double>(std::numeric_limits<T>::max());
}

/// Whether a number that stands in an ascii file is one of the declared type.
bool fits(PlyType type, double value) {
  switch (type) {
    case PlyType::int8:
      return holds<std::int8_t>(value);
    case PlyType::uint8:
      return holds<std::uint8_t>(value);
    case PlyType::int16:
      return holds<std::int16_t>(value);
    case PlyType::uint16:
      return holds<std::uint16_t>(value);
    case PlyType::int32:
      return holds<std::int32_t>(value);
    case PlyType::uint32:
      return holds<std::uint32_t>(value);
    case PlyType::float32:
    case PlyType::float64:
      return true;
  }
  return false;
}

std::string shown(double value) {
  std::string text;
  append_number(text, value, k_float_digits);
  return text;
}

}  // namespace

PlyReader::PlyReader(const std::filesystem::path& file)
    : file_(file),
      content_(read_whole_file(file_)),
      text_(file_, content_),
      header_(read_ply_header(text_)),
      bytes_(text_.rest(),
             header_.format == PlyFormat::binary_big_endian ? std::endian::big : std::endian::little) {}

const PlyElement& PlyReader::require(std::string_view element) const {
  if (const PlyElement* found = header_.find(element)) return *found;
  std::string names;
  for (const PlyElement& other : header_.elements) names += (names.empty() ? "" : ", ") + other.name;
  fail("there is no element " + in_quotes(element) + "; the file has: " + (names.empty() ? "none" : names));
}

std::optional<std::size_t> PlyReader::find_scalar(const PlyElement& element, std::string_view name) const {
  const std::optional<std::size_t> property = element.find(name);
  if (property && element.properties[*property].length_type) {
    fail("element " + in_quotes(element.name) + ": property " + in_quotes(name) + " must not be a list");
  }
  return property;
}

std::optional<std::array<std::size_t, 3>> PlyReader::find_vector(const PlyElement& element,
                                                                 const std::array<const char*, 3>& names,
                                                                 bool needed) const {
  std::array<std::size_t, 3> found{};
  std::string missing;
  std::size_t present = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (const auto property = find_scalar(element, names[axis])) {
      found[axis] = *property;
      ++present;
    } else {
      missing += (missing.empty() ? "" : ", ") + in_quotes(names[axis]);
    }
  }
  if (present == 3) return found;
  if (present == 0 && !needed) return std::nullopt;
  fail("element " + in_quotes(element.name) + " lacks " + missing);
}

const PlyElement* PlyReader::next_element() {
  if (element_) {
    kept_list_.reset();
    while (next_row()) {
    }
  }
  element_ = next_ < header_.elements.size() ? &header_.elements[next_++] : nullptr;
  rows_read_ = 0;
  kept_list_.reset();
  if (element_) values_.assign(element_->properties.size(), 0.0);
  return element_;
}

bool PlyReader::next_row() {
  if (rows_read_ == element_->count) return false;
  ++rows_read_;
  const bool ascii = header_.format == PlyFormat::ascii;
  while (ascii) {
    if (!text_.next_line()) fail_row("", "the file ends before this row");
    if (text_.line().find_first_not_of(" \t") != std::string_view::npos) break;
  }
  for (std::size_t k = 0; k < element_->properties.size(); ++k) {
    const PlyProperty& property = element_->properties[k];
    values_[k] = read_scalar(property.length_type.value_or(property.type));
    if (property.length_type) read_list(k);
  }
  if (ascii && !text_.word().empty()) fail_row("", "there are more numbers on this line than properties");
  return true;
}

void PlyReader::read_list(std::size_t property) {
  const PlyProperty& list = element_->properties[property];
  const double length = values_[property];
  if (length < 0) fail_row(list.name, "length " + shown(length) + " is not allowed: at least 0");
  const auto count = static_cast<std::uint64_t>(length);
  const bool kept = kept_list_ == property;
  if (kept) {
    list_.clear();
    if (count > k_max_polygon_corners) {
      fail_row(list.name, counted(count, "corner") + " are not allowed: at most " +
                              std::to_string(k_max_polygon_corners));
    }
  }
  for (std::uint64_t k = 0; k < count; ++k) {
    const double entry = read_scalar(list.type);
    if (kept) list_.push_back(entry);
  }
}

double PlyReader::read_scalar(PlyType type) {
  return header_.format == PlyFormat::ascii ? read_ascii(type) : read_binary(type);
}

double PlyReader::read_ascii(PlyType type) {
  const double value = text_.number(element_->name.c_str());
  if (!fits(type, value)) fail_row("", shown(value) + " is not a number of the declared type");
  return value;
}

double PlyReader::read_binary(PlyType type) {
  const auto read = [&]<class T>(T) {
    const std::optional<T> value = bytes_.read<T>();
    if (!value) fail_row("", "the file ends in this row");
    return static_cast<double>(*value);
  };
  switch (type) {
    case PlyType::int8:
      return read(std::int8_t{});
    case PlyType::uint8:
      return read(std::uint8_t{});
    case PlyType::int16:
      return read(std::int16_t{});
    case PlyType::uint16:
      return read(std::uint16_t{});
    case PlyType::int32:
      return read(std::int32_t{});
    case PlyType::uint32:
      return read(std::uint32_t{});
    case PlyType::float32:
      return read(float{});
    case PlyType::float64:
      return read(double{});
  }
  return 0;
}

Eigen::Vector3d PlyReader::finite_point(const std::array<std::size_t, 3>& properties) const {
  Eigen::Vector3d vector;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double value = values_[properties[axis]];
    if (!std::isfinite(static_cast<float>(value))) fail_value(properties[axis], "a finite number");
    vector[static_cast<Eigen::Index>(axis)] = value;
  }
  return vector;
}

std::uint32_t PlyReader::index(double value, std::uint64_t limit, const char* what) const {
  if (!(value >= 0 && value < static_cast<double>(limit) && value == std::floor(value))) {
    fail_row(what, shown(value) + " is not allowed: " +
                       (limit == 0 ? std::string("there is none")
                                   : "a whole number from 0 to " + std::to_string(limit - 1)));
  }
  return static_cast<std::uint32_t>(value);
}

void PlyReader::fail(const std::string& message) const {
  fail_file(file_, message);
}

void PlyReader::fail_value(std::size_t property, const std::string& allowed) const {
  fail_row(element_->properties[property].name, shown(values_[property]) + " is not allowed: " + allowed);
}

void PlyReader::fail_row(const std::string& property, const std::string& message) const {
  // Rows are counted from 0, as indices in the file count them.
  std::string field = element_->name + ' ' + std::to_string(rows_read_ - 1);
  if (!property.empty()) field += ", " + property;
  if (header_.format == PlyFormat::ascii) text_.fail(std::move(field), message);
  throw IoError(
      Problem{.file = file_.string(), .line = 0, .column = 0, .field = std::move(field), .message = message});
}

}  // namespace mallow
