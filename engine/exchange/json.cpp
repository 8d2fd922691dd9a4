#include "engine/exchange/json.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/text.h"

namespace spoonbill {

namespace {

constexpr std::size_t depth_limit = 64;
constexpr std::size_t value_limit = 6'000'000;
constexpr std::size_t field_limit = 1'000;
constexpr std::size_t complaint_limit = 120;
constexpr std::size_t page_width = 110;
constexpr std::size_t excerpt_limit = 40;

// Input iterator that records how far the parser has read, so that the message of a refusal by StrictBuilder
// can give the position.
class TrackedIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackedIterator(const char* position, const char** furthest) : position_(position), furthest_(furthest) {}
  reference operator*() const { return *position_; }
  TrackedIterator& operator++() {
    *furthest_ = ++position_;
    return *this;
  }
  TrackedIterator operator++(int) {
    TrackedIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const TrackedIterator& a, const TrackedIterator& b) {
    return a.position_ == b.position_;
  }

 private:
  const char* position_;
  const char** furthest_;
};

// SAX handler that builds the value and enforces limits that the grammar of JSON does not have.
class StrictBuilder : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return refuse(ErrorCode::malformed, "binary values are not JSON"); }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    auto& fields = open_.back()->get_ref<Json::object_t&>();
    if (fields.size() >= field_limit) {
      return refuse(ErrorCode::too_many,
                    "an object has more than " + std::to_string(field_limit) + " fields");
    }
    const auto [field, is_new] = fields.emplace(name, nullptr);
    if (!is_new) {
      field_ = name;
      return refuse(ErrorCode::duplicate, "field " + json_excerpt(name) + " is given twice");
    }
    slot_ = &field->second;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const Json::exception& exception) override {
    error_offset_ = position;
    const std::string text = exception.what();
    const std::string_view noise = "syntax error while ";
    const std::size_t start = text.find(noise);
    return refuse(ErrorCode::malformed, start == std::string::npos
                                            ? text.substr(std::min(text.find("] ") + 2, text.size()))
                                            : text.substr(start + noise.size()));
  }

  ErrorCode code() const { return code_; }
  const std::string& complaint() const { return complaint_; }
  const std::string& field() const { return field_; }  // name of a field that is given twice; otherwise empty
  // Offset of a syntax error in bytes; nullopt if the builder itself refused the text.
  std::optional<std::size_t> error_offset() const { return error_offset_; }
  Json release_value() { return std::move(root_); }

 private:
  bool refuse(ErrorCode code, std::string complaint) {
    code_ = code;
    complaint_ = std::move(complaint);
    return false;
  }

  Json* insert(Json value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    if (slot_ != nullptr) {
      *slot_ = std::move(value);
      return std::exchange(slot_, nullptr);
    }
    open_.back()->push_back(std::move(value));
    return &open_.back()->back();
  }

  bool add(Json value) {
    if (++values_ > value_limit) {
      return refuse(ErrorCode::too_many, "more than " + std::to_string(value_limit) + " values");
    }
    insert(std::move(value));
    return true;
  }

  bool open(Json value) {
    if (open_.size() >= depth_limit) {
      return refuse(ErrorCode::too_many, "nested deeper than " + std::to_string(depth_limit) + " levels");
    }
    if (++values_ > value_limit) {
      return refuse(ErrorCode::too_many, "more than " + std::to_string(value_limit) + " values");
    }
    open_.push_back(insert(std::move(value)));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  Json root_;
  std::vector<Json*> open_;  // containers around the next value, outermost first
  // Place for the value of the field name that was just read; null if the next value has no name.
  Json* slot_ = nullptr;
  std::size_t values_ = 0;
  ErrorCode code_ = ErrorCode::malformed;
  std::string complaint_;
  std::string field_;
  std::optional<std::size_t> error_offset_;
};

std::string to_printable_line(std::string text) {
  for (char& c : text) {
    if (c < 0x20 || c > 0x7e) c = '?';
  }
  if (text.size() > complaint_limit) text = text.substr(0, complaint_limit) + "...";
  return text;
}

// Returns "line L, column C", or the column alone if the text has one line. `position` counts bytes from 1.
std::string position_text(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, std::min(position > 0 ? position - 1 : 0, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t last_break = before.rfind('\n');
  const std::size_t column = before.size() - (last_break == std::string_view::npos ? 0 : last_break + 1) + 1;
  const bool single_line =
      text.substr(0, text.size() - (text.empty() ? 0 : 1)).find('\n') == std::string_view::npos;
  return (single_line ? "" : "line " + std::to_string(line) + ", ") + "column " + std::to_string(column);
}

std::string escape(const std::string& text) {
  return json_to_line(Json(text));
}

// Appends the value on one line with a space after each comma and colon. Returns false, with only a part
// appended, as soon as `out` exceeds `width`.
bool append_spaced(const Json& json, std::size_t width, std::string& out) {
  if (json.is_object() || json.is_array()) {
    out += json.is_object() ? '{' : '[';
    bool first = true;
    for (const auto& item : json.items()) {
      if (!first) out += ", ";
      first = false;
      if (json.is_object()) out += escape(item.key()) + ": ";
      if (!append_spaced(item.value(), width, out)) return false;
    }
    out += json.is_object() ? '}' : ']';
  } else {
    out += json_to_line(json);
  }
  return out.size() <= width;
}

// Appends the value in the layout of json_to_page(). `before` is the number of columns that are already used
// on the first line.
void append_page(const Json& json, std::size_t indent, std::size_t before, std::string& out) {
  std::string line;
  const bool structured = json.is_object() || json.is_array();
  if (!structured || json.empty() || append_spaced(json, page_width - std::min(page_width, before), line)) {
    out += structured ? (json.empty() ? json_to_line(json) : line) : json_to_line(json);
    return;
  }
  const std::string margin(indent + 2, ' ');
  out += json.is_object() ? "{\n" : "[\n";
  bool first = true;
  for (const auto& item : json.items()) {
    if (!first) out += ",\n";
    first = false;
    const std::string name = json.is_object() ? escape(item.key()) + ": " : "";
    out += margin + name;
    append_page(item.value(), indent + 2, margin.size() + name.size(), out);
  }
  out += "\n" + std::string(indent, ' ') + (json.is_object() ? "}" : "]");
}

constexpr double millimetres_per_metre = 1000.0;
constexpr std::size_t longest_whole = 64;
constexpr std::size_t longest_fraction = 350;  // enough for the digits of the smallest double

bool have_same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Returns the shortest number of millimetres that reads back to the same bits; nullopt if no number of
// millimetres does.
std::optional<double> shortest_millimetres(double metres) {
  const double near = metres * millimetres_per_metre;
  std::optional<double> best;
  std::size_t best_length = 0;
  for (const double candidate : {near, std::nextafter(near, -infinity), std::nextafter(near, infinity)}) {
    if (!have_same_bits(candidate / millimetres_per_metre, metres)) continue;
    const std::size_t length = number_text(candidate).size();
    if (best && length >= best_length) continue;
    best = candidate;
    best_length = length;
  }
  return best;
}

// Returns the shortest decimal of `metres`, with the decimal point moved three places to the right. The
// result need not equal any double.
std::string decimal_millimetres(double metres) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), std::abs(metres), std::chars_format::scientific)
          .ptr;
  const std::string_view scientific(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::size_t e = scientific.find('e');
  std::string digits(1, scientific[0]);
  if (e > 1) digits += scientific.substr(2, e - 2);
  int exponent = 0;
  const std::size_t exponent_start = e + (scientific[e + 1] == '+' ? 2 : 1);
  std::from_chars(scientific.data() + exponent_start, scientific.data() + scientific.size(), exponent);

  int point = exponent + 1 + 3;  // digits before the decimal point
  if (point <= 0) {
    digits.insert(0, static_cast<std::size_t>(1 - point), '0');
    point = 1;
  }
  if (static_cast<int>(digits.size()) < point) {
    digits.append(static_cast<std::size_t>(point) - digits.size(), '0');
  }
  if (static_cast<int>(digits.size()) > point) digits.insert(static_cast<std::size_t>(point), 1, '.');
  return (std::signbit(metres) ? "-" : "") + digits;
}

bool is_plain_decimal(std::string_view text) {
  if (text.empty()) return false;
  if (text.front() == '-') text.remove_prefix(1);
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view fraction = point == std::string_view::npos ? "0" : text.substr(point + 1);
  if (whole.size() > longest_whole || fraction.size() > longest_fraction) return false;
  const auto all_digits = [](std::string_view part) {
    return !part.empty() && part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return all_digits(whole) && all_digits(fraction);
}

}  // namespace

Result<Json> parse_json(std::string_view text, const std::string& source) {
  const char* furthest = text.data();
  StrictBuilder builder;
  const bool parsed = Json::sax_parse(TrackedIterator(text.data(), &furthest),
                                      TrackedIterator(text.data() + text.size(), &furthest), &builder);
  if (parsed) {
    // The parser would treat a zero byte as the end of the text, whatever follows.
    const std::size_t zero = text.find('\0');
    if (zero == std::string_view::npos) return builder.release_value();
    return Error{ErrorCode::malformed,
                 source + ": " + position_text(text, zero + 1) + ": a zero byte, which is not JSON"};
  }
  const auto read = static_cast<std::size_t>(furthest - text.data());
  return Error{builder.code(),
               source + ": " + position_text(text, builder.error_offset().value_or(read)) + ": " +
                   to_printable_line(builder.complaint()),
               builder.field()};
}

std::string json_to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string json_to_page(const Json& json) {
  std::string page;
  append_page(json, 0, 0, page);
  page += '\n';
  return page;
}

std::string json_excerpt(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_array()) return "a list of " + std::to_string(json.size());
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > excerpt_limit) text = text.substr(0, excerpt_limit) + "...";
  return text;
}

Json number_to_json(double number) {
  constexpr double exact_integers = 9007199254740992.0;  // 2^53
  const bool whole = std::trunc(number) == number && std::abs(number) < exact_integers;
  if (whole && !(number == 0.0 && std::signbit(number))) return static_cast<std::int64_t>(number);
  return number;
}

Json length_to_json(double metres) {
  if (const auto millimetres = shortest_millimetres(metres)) return number_to_json(*millimetres);
  return decimal_millimetres(metres);
}

std::optional<double> length_from_json(const Json& millimetres) {
  if (millimetres.is_number()) return millimetres.get<double>() / millimetres_per_metre;
  if (!millimetres.is_string()) return std::nullopt;
  const auto& text = millimetres.get_ref<const std::string&>();
  if (!is_plain_decimal(text)) return std::nullopt;
  const std::string in_metres = text + "e-3";
  double metres = 0.0;
  const auto result = std::from_chars(in_metres.data(), in_metres.data() + in_metres.size(), metres);
  if (result.ec != std::errc{}) return std::nullopt;
  return metres;
}

}  // namespace spoonbill
