#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "engine/base/text.h"
#include "engine/exchange/scans/number_lines.h"
#include "engine/exchange/scans/point_cloud.h"

namespace spoonbill {
namespace {

constexpr std::size_t header_lines_limit = 100;
constexpr std::size_t pcd_field_limit = 64;

struct PcdField {
  std::string_view name;
  NumberType type = NumberType::float32;
  std::uint64_t count = 1;
  // Position of the field's first number: in text, its index among the numbers of a point; in binary form,
  // its byte offset within a point; in compressed form, its byte offset within the decompressed data.
  std::size_t offset = 0;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::string_view data;  // form of the body: "ascii", "binary" or "binary_compressed"
  std::string_view body;
};

std::optional<NumberType> find_type(char letter, std::uint64_t size) {
  if (letter == 'F') {
    if (size == 4) return NumberType::float32;
    if (size == 8) return NumberType::float64;
  }
  const bool is_signed = letter == 'I';
  if (!is_signed && letter != 'U') return {};
  switch (size) {
    case 1:
      return is_signed ? NumberType::int8 : NumberType::uint8;
    case 2:
      return is_signed ? NumberType::int16 : NumberType::uint16;
    case 4:
      return is_signed ? NumberType::int32 : NumberType::uint32;
    case 8:
      return is_signed ? NumberType::int64 : NumberType::uint64;
    default:
      return {};
  }
}

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::string_view word = extract_word(text); !word.empty() && words.size() <= pcd_field_limit;
       word = extract_word(text)) {
    words.push_back(word);
  }
  return words;
}

// Contents of a header's lines, by keyword.
struct HeaderLines {
  std::vector<std::string_view> fields, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
};

bool is_product(std::uint64_t product, std::uint64_t a, std::uint64_t b) {
  return a == 0 ? product == 0 : product / a == b && product % a == 0;
}

Result<PcdHeader> make_header(const HeaderLines& lines, std::string_view data, std::string_view body) {
  PcdHeader header{{}, 0, data, body};
  const std::size_t count = lines.fields.size();
  if (count == 0 || count > pcd_field_limit)
    return Error{ErrorCode::missing, "its header has no FIELDS line"};
  if (lines.sizes.size() != count || lines.types.size() != count ||
      (!lines.counts.empty() && lines.counts.size() != count)) {
    return Error{ErrorCode::inconsistent,
                 "its header must list as many values for SIZE, TYPE and COUNT as for FIELDS"};
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto size = parse_count(lines.sizes[k]);
    const auto type = find_type(lines.types[k][0], size.value_or(0));
    const auto numbers =
        lines.counts.empty() ? std::optional<std::uint64_t>(1) : parse_count(lines.counts[k]);
    if (!type || !numbers || *numbers > 100'000) {
      return Error{ErrorCode::unsupported, "field " + std::string(lines.fields[k].substr(0, 40)) +
                                               " has an unknown SIZE, TYPE or COUNT"};
    }
    header.fields.push_back({lines.fields[k], *type, *numbers});
  }
  const auto is_empty = [](const PcdField& field) { return field.count == 0; };
  if (std::all_of(header.fields.begin(), header.fields.end(), is_empty)) {
    return Error{ErrorCode::too_few, "its fields are empty: each COUNT is 0"};
  }
  if (lines.points) {
    header.points = *lines.points;
    if (lines.width && lines.height && !is_product(*lines.points, *lines.width, *lines.height)) {
      return Error{ErrorCode::inconsistent, "its POINTS are not WIDTH times HEIGHT; the file is damaged"};
    }
  } else if (lines.width && lines.height && *lines.width <= point_limit && *lines.height <= point_limit) {
    header.points = *lines.width * *lines.height;
  } else {
    return Error{ErrorCode::missing, "its header does not state the number of POINTS"};
  }
  return header;
}

Result<PcdHeader> read_pcd_header(std::string_view bytes) {
  HeaderLines lines;
  for (std::size_t line = 0; line < header_lines_limit && !bytes.empty(); ++line) {
    std::string_view rest = extract_line(bytes);
    const std::string_view keyword = extract_word(rest);
    if (keyword == "FIELDS" || keyword == "COLUMNS") lines.fields = split_words(rest);
    if (keyword == "SIZE") lines.sizes = split_words(rest);
    if (keyword == "TYPE") lines.types = split_words(rest);
    if (keyword == "COUNT") lines.counts = split_words(rest);
    if (keyword == "WIDTH") lines.width = parse_count(extract_word(rest));
    if (keyword == "HEIGHT") lines.height = parse_count(extract_word(rest));
    if (keyword == "POINTS") lines.points = parse_count(extract_word(rest));
    if (keyword == "DATA") return make_header(lines, extract_word(rest), bytes);
  }
  return Error{ErrorCode::malformed, "its header has no DATA line; it is cut or not a PCD file"};
}

// Returns the indices of the fields x, y, z, normal_x, normal_y and normal_z; -1 for missing ones.
std::array<int, 6> find_coordinate_fields(const std::vector<PcdField>& fields) {
  static constexpr std::array<std::string_view, 6> names{"x", "y", "z", "normal_x", "normal_y", "normal_z"};
  std::array<int, 6> columns;
  columns.fill(-1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (fields[f].name == names[k] && fields[f].count > 0) columns[k] = static_cast<int>(f);
    }
  }
  return columns;
}

Error comma_error(std::uint64_t point, std::string_view word) {
  return Error{ErrorCode::malformed, "point " + std::to_string(point + 1) + " has '" + excerpt(word) +
                                         "', a number with a comma; write decimal points"};
}

Error truncated_error(std::uint64_t point, std::uint64_t points) {
  return Error{ErrorCode::malformed, "it ends or has no number at point " + std::to_string(point + 1) +
                                         " of " + std::to_string(points) + "; it is cut or damaged"};
}

// Returns an error if anything other than padding (blanks or zeros) follows the last point.
Status check_rest(std::string_view rest, std::uint64_t points) {
  constexpr std::string_view padding("\0 \t\r\v\f\n", 7);
  if (rest.find_first_not_of(padding) == std::string_view::npos) return {};
  return Error{ErrorCode::inconsistent, "holds more than the " + std::to_string(points) +
                                            " points that its header states; the file is damaged"};
}

// Collects all points. `number(point, field)` returns a coordinate, or nullopt where the file ends early.
template <class Number>
Result<PointCloud> collect_points(const PcdHeader& header, const Number& number) {
  const std::array<int, 6> columns = find_coordinate_fields(header.fields);
  if (std::min({columns[0], columns[1], columns[2]}) < 0) {
    return Error{ErrorCode::missing, "its points have no x, y and z"};
  }
  const bool with_normals = std::min({columns[3], columns[4], columns[5]}) >= 0;
  PointCollector collector;
  if (Status begun = collector.begin(header.points, with_normals); !begun) return begun.error();
  for (std::uint64_t p = 0; p < header.points; ++p) {
    std::array<double, 6> values{};
    for (std::size_t k = 0; k < (with_normals ? 6U : 3U); ++k) {
      const std::optional<double> value = number(p, static_cast<std::size_t>(columns[k]));
      if (!value) return truncated_error(p, header.points);
      values[k] = *value;
    }
    const Status added = collector.add({values[0], values[1], values[2]}, {values[3], values[4], values[5]});
    if (!added) return added.error();
  }
  return std::move(collector).finish();
}

Result<PointCloud> read_text_body(PcdHeader header) {
  std::size_t numbers = 0;
  for (PcdField& field : header.fields) {
    field.offset = numbers;
    numbers += field.count;
  }
  // A number and its separator take at least two bytes, which limits the number of points.
  const std::uint64_t available = numbers == 0 ? 0 : header.body.size() / (2 * numbers);
  if (header.points <= point_limit && header.points > available + 1) {
    return truncated_error(available, header.points);
  }
  std::vector<double> row(numbers);
  std::uint64_t rows_read = 0;
  std::string_view rest = header.body, word;
  const auto number = [&](std::uint64_t point, std::size_t field) -> std::optional<double> {
    for (; rows_read <= point; ++rows_read) {
      for (double& value : row) {
        word = extract_word(rest);
        const auto read = parse_number(word);
        if (!read) return {};
        value = *read;
      }
    }
    return row[header.fields[field].offset];
  };
  auto cloud = collect_points(header, number);
  if (cloud) {
    if (Status ended = check_rest(rest, header.points); !ended) return ended.error();
  }
  const bool has_comma = !cloud && word.find(',') != std::string_view::npos;
  return has_comma ? comma_error(rows_read, word) : std::move(cloud);
}

constexpr bool swapped = std::endian::native == std::endian::big;

// Reads a binary body, in which all numbers of a point are stored together.
Result<PointCloud> read_binary_body(PcdHeader header) {
  std::size_t stride = 0;
  for (PcdField& field : header.fields) {
    field.offset = stride;
    stride += field.count * byte_count(field.type);
  }
  const std::uint64_t available = stride == 0 ? 0 : header.body.size() / stride;
  if (header.points <= point_limit && header.points > available) {
    return truncated_error(available, header.points);
  }
  if (header.points <= available) {
    const Status ended = check_rest(header.body.substr(header.points * stride), header.points);
    if (!ended) return ended.error();
  }
  return collect_points(header, [&](std::uint64_t point, std::size_t field) -> std::optional<double> {
    const PcdField& values = header.fields[field];
    return number_at(header.body.data() + point * stride + values.offset, values.type, swapped);
  });
}

// Reads a compressed body: the compressed size, the full size, then LZF data with all values of the first
// field, all values of the second, and so on.
Result<PointCloud> read_compressed_body(PcdHeader header) {
  if (header.points > point_limit) {
    return collect_points(header, [](auto, auto) { return std::optional<double>(); });
  }
  std::array<std::uint32_t, 2> lengths{};
  if (header.body.size() < sizeof lengths) return truncated_error(0, header.points);
  std::memcpy(lengths.data(), header.body.data(), sizeof lengths);
  header.body.remove_prefix(sizeof lengths);
  std::size_t size = 0;
  for (PcdField& field : header.fields) {
    field.offset = size;
    size += header.points * field.count * byte_count(field.type);
  }
  if (size != lengths[1] || size == 0 || size > point_file_bytes_limit || lengths[0] > header.body.size()) {
    return Error{
        ErrorCode::malformed,
        "its compressed data do not have the length that its header states; the file is cut or damaged"};
  }
  std::string bytes(size, '\0');
  if (lzf_decompress(header.body.data(), lengths[0], bytes.data(), lengths[1]) != size) {
    return Error{ErrorCode::malformed, "its compressed data cannot be decompressed; the file is damaged"};
  }
  return collect_points(header, [&](std::uint64_t point, std::size_t field) -> std::optional<double> {
    const PcdField& values = header.fields[field];
    return number_at(bytes.data() + values.offset + point * values.count * byte_count(values.type),
                     values.type, swapped);
  });
}

}  // namespace

Result<PointCloud> parse_pcd_points(std::string_view bytes) {
  auto header = read_pcd_header(bytes);
  if (!header) return header.error();
  const std::string_view data = header->data;
  if (data == "ascii") return read_text_body(std::move(header).value());
  if (data == "binary") return read_binary_body(std::move(header).value());
  if (data == "binary_compressed") return read_compressed_body(std::move(header).value());
  return Error{ErrorCode::unsupported, "its DATA are '" + std::string(data.substr(0, 40)) +
                                           "'; only ascii, binary and binary_compressed can be read"};
}

}  // namespace spoonbill
