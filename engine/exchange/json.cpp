#include "engine/exchange/json.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

namespace spoonbill {

namespace {

constexpr std::size_t depth_limit = 64;
constexpr std::size_t value_limit = 6'000'000;
constexpr std::size_t field_limit = 1'000;
constexpr std::size_t complaint_limit = 120;

// Tells how far the parser has read, so that a refusal that is not the parser's own can say where.
class TrackedIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackedIterator(const char* at, const char** furthest) : at_(at), furthest_(furthest) {}
  reference operator*() const { return *at_; }
  TrackedIterator& operator++() {
    *furthest_ = ++at_;
    return *this;
  }
  TrackedIterator operator++(int) {
    TrackedIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const TrackedIterator& a, const TrackedIterator& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  const char** furthest_;
};

// Builds the value while it enforces what the grammar alone does not.
class StrictBuilder : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return refuse("binary values are not JSON"); }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    auto& fields = open_.back()->get_ref<Json::object_t&>();
    if (fields.size() >= field_limit) {
      return refuse("an object has more than " + std::to_string(field_limit) + " fields");
    }
    const auto [field, is_new] = fields.emplace(name, nullptr);
    if (!is_new) return refuse("field " + json_excerpt(name) + " is given twice");
    slot_ = &field->second;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const Json::exception& exception) override {
    position_ = position;
    const std::string text = exception.what();
    const std::string_view noise = "syntax error while ";
    const std::size_t start = text.find(noise);
    return refuse(start == std::string::npos ? text.substr(std::min(text.find("] ") + 2, text.size()))
                                             : text.substr(start + noise.size()));
  }

  const std::string& complaint() const { return complaint_; }
  std::optional<std::size_t> position() const { return position_; }
  Json take() { return std::move(root_); }

 private:
  bool refuse(std::string complaint) {
    complaint_ = std::move(complaint);
    return false;
  }

  Json* place(Json value) {
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
    if (++values_ > value_limit) return refuse("more than " + std::to_string(value_limit) + " values");
    place(std::move(value));
    return true;
  }

  bool open(Json value) {
    if (open_.size() >= depth_limit) {
      return refuse("nested deeper than " + std::to_string(depth_limit) + " levels");
    }
    if (++values_ > value_limit) return refuse("more than " + std::to_string(value_limit) + " values");
    open_.push_back(place(std::move(value)));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  Json root_;
  std::vector<Json*> open_;  // the containers around the next value, outermost first
  Json* slot_ = nullptr;     // where the value of the field just named goes
  std::size_t values_ = 0;
  std::string complaint_;
  std::optional<std::size_t> position_;
};

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c < 0x20 || c > 0x7e) c = '?';
  }
  if (text.size() > complaint_limit) text = text.substr(0, complaint_limit) + "...";
  return text;
}

std::string place_in(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, std::min(position > 0 ? position - 1 : 0, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t last_break = before.rfind('\n');
  const std::size_t column = before.size() - (last_break == std::string_view::npos ? 0 : last_break + 1) + 1;
  const bool single_line =
      text.substr(0, text.size() - (text.empty() ? 0 : 1)).find('\n') == std::string_view::npos;
  return (single_line ? "" : "line " + std::to_string(line) + ", ") + "column " + std::to_string(column);
}

}  // namespace

Result<Json> parse_json(std::string_view text, const std::string& source) {
  const char* furthest = text.data();
  StrictBuilder builder;
  const bool parsed = Json::sax_parse(TrackedIterator(text.data(), &furthest),
                                      TrackedIterator(text.data() + text.size(), &furthest), &builder);
  if (parsed) {
    // The parser takes one for the end, whatever follows.
    const std::size_t zero = text.find('\0');
    if (zero == std::string_view::npos) return builder.take();
    return Error{source + ": " + place_in(text, zero + 1) + ": a zero byte, which is not JSON"};
  }
  const auto read = static_cast<std::size_t>(furthest - text.data());
  return Error{source + ": " + place_in(text, builder.position().value_or(read)) + ": " +
               one_line(builder.complaint())};
}

Json number_to_json(double number) {
  constexpr double exact_integers = 9007199254740992.0;  // 2^53
  const bool whole = std::trunc(number) == number && std::abs(number) < exact_integers;
  if (whole && !(number == 0.0 && std::signbit(number))) return static_cast<std::int64_t>(number);
  return number;
}

}  // namespace spoonbill
