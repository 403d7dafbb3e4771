#include <limits>
#include <utility>

#include "files/ply.h"

namespace mallow {
namespace {

/// Of all elements together: no real file comes near, and names are compared one by one.
constexpr std::size_t k_max_ply_properties = 1000;
/// Comments too, which are kept.
constexpr std::size_t k_max_ply_header_bytes = std::size_t{1} << 20;

constexpr std::pair<std::string_view, PlyType> k_type_names[] = {
    {"char", PlyType::int8},      {"uchar", PlyType::uint8},    {"short", PlyType::int16},
    {"ushort", PlyType::uint16},  {"int", PlyType::int32},      {"uint", PlyType::uint32},
    {"float", PlyType::float32},  {"double", PlyType::float64}, {"int8", PlyType::int8},
    {"uint8", PlyType::uint8},    {"int16", PlyType::int16},    {"uint16", PlyType::uint16},
    {"int32", PlyType::int32},    {"uint32", PlyType::uint32},  {"float32", PlyType::float32},
    {"float64", PlyType::float64}};

std::uint64_t size_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 8;
}

PlyType parse_type(const TextReader& text, std::string_view word, bool may_be_float) {
  for (const auto& [name, type] : k_type_names) {
    if (name != word) continue;
    if (!may_be_float && (type == PlyType::float32 || type == PlyType::float64)) break;
    return type;
  }
  text.fail("property", in_quotes(word) + " is not allowed: char uchar short ushort int uint" +
                            (may_be_float ? " float double" : "") + ", or the same with bits (int8 ...)");
}

void read_format(TextReader& text, std::optional<PlyFormat>& format) {
  if (format) text.fail("format", "is given twice");
  const std::string_view word = text.word();
  if (word == "ascii") {
    format = PlyFormat::ascii;
  } else if (word == "binary_little_endian") {
    format = PlyFormat::binary_little_endian;
  } else if (word == "binary_big_endian") {
    format = PlyFormat::binary_big_endian;
  } else {
    text.fail("format",
              in_quotes(word) + " is not allowed: ascii, binary_little_endian or binary_big_endian");
  }
  const std::string_view version = text.word();
  if (version != "1.0") text.fail("format", "version " + in_quotes(version) + " is not allowed: 1.0");
}

void read_element(TextReader& text, PlyHeader& header) {
  const std::string name(text.word());
  if (name.empty()) text.fail("element", "has no name");
  if (header.find(name)) text.fail("element", in_quotes(name) + " is given twice");
  PlyElement& element = header.elements.emplace_back();
  element.name = name;
  element.line = text.line_number();
  element.count =
      static_cast<std::uint64_t>(text.integer("element", 0, std::numeric_limits<std::int64_t>::max()));
}

void read_property(TextReader& text, PlyHeader& header) {
  if (header.elements.empty()) text.fail("property", "stands before any element");
  PlyElement& element = header.elements.back();
  PlyProperty property;
  std::string_view type = text.word();
  if (type == "list") {
    property.length_type = parse_type(text, text.word(), false);
    type = text.word();
  }
  property.type = parse_type(text, type, true);
  property.name = text.word();
  if (property.name.empty()) text.fail("property", "has no name");
  if (element.find(property.name)) text.fail("property", in_quotes(property.name) + " is given twice");
  element.properties.push_back(std::move(property));
}

/// The fewest bytes that a row can take.
std::uint64_t least_row_bytes(const PlyElement& element, PlyFormat format) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    // In ascii a digit and what parts it from the next.
    bytes += format == PlyFormat::ascii ? 2 : size_of(property.length_type.value_or(property.type));
  }
  return bytes;
}

void require_room_for_rows(const TextReader& text, const PlyHeader& header) {
  // The last row of an ascii file may lack its line end.
  std::uint64_t left = text.rest().size() + (header.format == PlyFormat::ascii ? 1 : 0);
  for (const PlyElement& element : header.elements) {
    const std::uint64_t row = least_row_bytes(element, header.format);
    if (element.count > 0 && row == 0) text.fail("element " + in_quotes(element.name), "has no properties");
    if (element.count > 0 && element.count > left / row) {
      text.fail("element " + in_quotes(element.name),
                "line " + std::to_string(element.line) + " promises " + counted(element.count, "row") +
                    " of at least " + counted(row, "byte") + ", but " + counted(left, "byte") + " are left");
    }
    require_room(text, element.count, "rows of an element");
    left -= element.count * row;
  }
}

}  // namespace

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return std::nullopt;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  for (const PlyElement& candidate : elements) {
    if (candidate.name == element) return &candidate;
  }
  return nullptr;
}

PlyHeader read_ply_header(TextReader& text) {
  PlyHeader header;
  const std::size_t whole = text.rest().size();
  if (!text.next_line() || text.word() != "ply" || !text.word().empty()) {
    text.fail("", "this is not a PLY file: the first line must be 'ply'");
  }
  std::optional<PlyFormat> format;
  std::size_t declared = 0;
  while (text.next_line()) {
    if (whole - text.rest().size() > k_max_ply_header_bytes) {
      text.fail("", "the header is too long: at most " + std::to_string(k_max_ply_header_bytes) +
                        " bytes are allowed");
    }
    const std::string_view keyword = text.word();
    if (keyword == "comment") {
      header.comments.emplace_back(text.rest_of_line());
    } else if (keyword == "obj_info") {
      text.rest_of_line();
    } else if (keyword == "format") {
      read_format(text, format);
    } else if (keyword == "element") {
      read_element(text, header);
      ++declared;
    } else if (keyword == "property") {
      read_property(text, header);
      ++declared;
    } else if (keyword == "end_header") {
      if (!format) text.fail("format", "is missing");
      header.format = *format;
      require_room_for_rows(text, header);
      return header;
    } else {
      text.fail("", in_quotes(keyword) +
                        " is not allowed: format, comment, obj_info, element, property or end_header");
    }
    if (!text.word().empty()) text.fail("", "there is more on this line than its keyword takes");
    if (declared > k_max_ply_properties) {
      text.fail("", "more than " + std::to_string(k_max_ply_properties) + " elements and properties");
    }
  }
  text.fail("", "the file ends before end_header");
}

}  // namespace mallow
