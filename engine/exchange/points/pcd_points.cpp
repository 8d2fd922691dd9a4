#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "engine/base/text.h"
#include "engine/exchange/points/number_lines.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {
namespace {

constexpr std::size_t header_lines_limit = 100;
constexpr std::size_t field_limit = 64;

struct PcdField {
  std::string_view name;
  NumberType type = NumberType::float32;
  std::uint64_t count = 1;
  std::size_t offset = 0;  // of its first number, in bytes of a point or, of a text, in numbers
};

struct Header {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::string_view data;  // how: "ascii", "binary", "binary_compressed"
  std::string_view body;
};

std::optional<NumberType> type_of(char letter, std::uint64_t size) {
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

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(text); !word.empty() && words.size() <= field_limit;
       word = take_word(text)) {
    words.push_back(word);
  }
  return words;
}

// The lines of a header by their keywords.
struct HeaderLines {
  std::vector<std::string_view> fields, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
};

Result<Header> header_from(const HeaderLines& lines, std::string_view data, std::string_view body) {
  Header header{{}, 0, data, body};
  const std::size_t count = lines.fields.size();
  if (count == 0 || count > field_limit) return Error{"its header names no FIELDS"};
  if (lines.sizes.size() != count || lines.types.size() != count ||
      (!lines.counts.empty() && lines.counts.size() != count)) {
    return Error{"its header has not as many SIZE, TYPE and COUNT as FIELDS"};
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto size = count_of(lines.sizes[k]);
    const auto type = type_of(lines.types[k][0], size.value_or(0));
    const auto numbers = lines.counts.empty() ? std::optional<std::uint64_t>(1) : count_of(lines.counts[k]);
    if (!type || !numbers || *numbers > 100'000) {
      return Error{"field " + std::string(lines.fields[k].substr(0, 40)) +
                   " has a SIZE, TYPE or COUNT that is not known"};
    }
    header.fields.push_back({lines.fields[k], *type, *numbers});
  }
  const auto is_empty = [](const PcdField& field) { return field.count == 0; };
  if (std::all_of(header.fields.begin(), header.fields.end(), is_empty)) {
    return Error{"its fields hold nothing: each COUNT is 0"};
  }
  if (lines.points) {
    header.points = *lines.points;
  } else if (lines.width && lines.height && *lines.width <= point_limit && *lines.height <= point_limit) {
    header.points = *lines.width * *lines.height;
  } else {
    return Error{"its header names no count of POINTS"};
  }
  return header;
}

Result<Header> header_of(std::string_view bytes) {
  HeaderLines lines;
  for (std::size_t line = 0; line < header_lines_limit && !bytes.empty(); ++line) {
    std::string_view rest = take_line(bytes);
    const std::string_view keyword = take_word(rest);
    if (keyword == "FIELDS" || keyword == "COLUMNS") lines.fields = words_of(rest);
    if (keyword == "SIZE") lines.sizes = words_of(rest);
    if (keyword == "TYPE") lines.types = words_of(rest);
    if (keyword == "COUNT") lines.counts = words_of(rest);
    if (keyword == "WIDTH") lines.width = count_of(take_word(rest));
    if (keyword == "HEIGHT") lines.height = count_of(take_word(rest));
    if (keyword == "POINTS") lines.points = count_of(take_word(rest));
    if (keyword == "DATA") return header_from(lines, take_word(rest), bytes);
  }
  return Error{"its header has no DATA line; it is cut or no PCD file"};
}

// The places of x, y, z and of a normal's among the fields; -1 for those that are not there.
std::array<int, 6> places_of(const std::vector<PcdField>& fields) {
  static constexpr std::array<std::string_view, 6> names{"x", "y", "z", "normal_x", "normal_y", "normal_z"};
  std::array<int, 6> places;
  places.fill(-1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (fields[f].name == names[k] && fields[f].count > 0) places[k] = static_cast<int>(f);
    }
  }
  return places;
}

Error number_with_comma(std::uint64_t point, std::string_view word) {
  return Error{"point " + std::to_string(point + 1) + " has '" + excerpt(word) +
               "', a number with a comma; write decimal points"};
}

Error ends_early(std::uint64_t point, std::uint64_t points) {
  return Error{"it ends or is no number at point " + std::to_string(point + 1) + " of " +
               std::to_string(points) + "; it is cut or damaged"};
}

// Gathers all points; `number(point, field)` is one of them, or nothing where the file has none.
template <class Number>
Result<PointCloud> gather(const Header& header, const Number& number) {
  const std::array<int, 6> places = places_of(header.fields);
  if (std::min({places[0], places[1], places[2]}) < 0) return Error{"its points have no x, y and z"};
  const bool with_normals = std::min({places[3], places[4], places[5]}) >= 0;
  PointGatherer gatherer;
  if (Status expected = gatherer.expect(header.points, with_normals); !expected) return expected.error();
  for (std::uint64_t p = 0; p < header.points; ++p) {
    std::array<double, 6> values{};
    for (std::size_t k = 0; k < (with_normals ? 6U : 3U); ++k) {
      const std::optional<double> value = number(p, static_cast<std::size_t>(places[k]));
      if (!value) return ends_early(p, header.points);
      values[k] = *value;
    }
    const Status added = gatherer.add({values[0], values[1], values[2]}, {values[3], values[4], values[5]});
    if (!added) return added.error();
  }
  return std::move(gatherer).done();
}

Result<PointCloud> text_body(Header header) {
  std::size_t numbers = 0;
  for (PcdField& field : header.fields) {
    field.offset = numbers;
    numbers += field.count;
  }
  // A number and what parts it from the next take two bytes.
  const std::uint64_t held = numbers == 0 ? 0 : header.body.size() / (2 * numbers);
  if (header.points <= point_limit && header.points > held + 1) return ends_early(held, header.points);
  std::vector<double> row(numbers);
  std::uint64_t rows_read = 0;
  std::string_view rest = header.body, word;
  const auto number = [&](std::uint64_t point, std::size_t field) -> std::optional<double> {
    for (; rows_read <= point; ++rows_read) {
      for (double& value : row) {
        word = take_word(rest);
        const auto read = number_of(word);
        if (!read) return {};
        value = *read;
      }
    }
    return row[header.fields[field].offset];
  };
  auto cloud = gather(header, number);
  const bool has_comma = !cloud && word.find(',') != std::string_view::npos;
  return has_comma ? number_with_comma(rows_read, word) : std::move(cloud);
}

constexpr bool swapped = std::endian::native == std::endian::big;

// One point after another.
Result<PointCloud> binary_body(Header header) {
  std::size_t stride = 0;
  for (PcdField& field : header.fields) {
    field.offset = stride;
    stride += field.count * bytes_of(field.type);
  }
  const std::uint64_t held = stride == 0 ? 0 : header.body.size() / stride;
  if (header.points <= point_limit && header.points > held) return ends_early(held, header.points);
  return gather(header, [&](std::uint64_t point, std::size_t field) -> std::optional<double> {
    const PcdField& of = header.fields[field];
    return number_at(header.body.data() + point * stride + of.offset, of.type, swapped);
  });
}

// Two lengths, then all of the first field, all of the second and so on, compressed.
Result<PointCloud> compressed_body(Header header) {
  if (header.points > point_limit) return gather(header, [](auto, auto) { return std::optional<double>(); });
  std::array<std::uint32_t, 2> lengths{};
  if (header.body.size() < sizeof lengths) return ends_early(0, header.points);
  std::memcpy(lengths.data(), header.body.data(), sizeof lengths);
  header.body.remove_prefix(sizeof lengths);
  std::size_t size = 0;
  for (PcdField& field : header.fields) {
    field.offset = size;
    size += header.points * field.count * bytes_of(field.type);
  }
  if (size != lengths[1] || size == 0 || size > point_file_bytes_limit || lengths[0] > header.body.size()) {
    return Error{"its compressed data has not the length that its header promises; it is cut or damaged"};
  }
  std::string bytes(size, '\0');
  if (lzf_decompress(header.body.data(), lengths[0], bytes.data(), lengths[1]) != size) {
    return Error{"its compressed data cannot be unpacked; it is damaged"};
  }
  return gather(header, [&](std::uint64_t point, std::size_t field) -> std::optional<double> {
    const PcdField& of = header.fields[field];
    return number_at(bytes.data() + of.offset + point * of.count * bytes_of(of.type), of.type, swapped);
  });
}

}  // namespace

Result<PointCloud> pcd_points(std::string_view bytes) {
  auto header = header_of(bytes);
  if (!header) return header.error();
  const std::string_view data = header->data;
  if (data == "ascii") return text_body(std::move(header).value());
  if (data == "binary") return binary_body(std::move(header).value());
  if (data == "binary_compressed") return compressed_body(std::move(header).value());
  return Error{"its DATA are '" + std::string(data.substr(0, 40)) +
               "'; ascii, binary and binary_compressed are read"};
}

}  // namespace spoonbill
