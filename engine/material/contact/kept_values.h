// Values that contacts keep from one tick to the next, such as the forces with which they pushed.
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <vector>

namespace spoonbill {

// Identifies a contact from tick to tick by the indices of its two bodies and a number of the point on the
// first body. For the contacts of a tool, `first` is the body, and `second` is not used.
struct ContactKey {
  int first = 0, second = 0, point = 0;

  auto operator<=>(const ContactKey&) const = default;
};

// Values of contacts by their keys. Call add() for all values, then sort(), then find(). Has one owner, on
// one thread. Allocates only in its constructor.
template <class Value>
class KeptValues {
 public:
  explicit KeptValues(std::size_t capacity) { values_.reserve(capacity); }

  void clear() { values_.clear(); }
  void add(const ContactKey& key, const Value& value) { values_.push_back({key, value}); }
  void sort() {
    std::sort(values_.begin(), values_.end(), [](const Kept& a, const Kept& b) { return a.key < b.key; });
  }
  // Returns the value of a contact, or null if none was added.
  const Value* find(const ContactKey& key) const {
    const auto at = std::lower_bound(values_.begin(), values_.end(), key,
                                     [](const Kept& kept, const ContactKey& k) { return kept.key < k; });
    return at != values_.end() && at->key == key ? &at->value : nullptr;
  }

 private:
  struct Kept {
    ContactKey key;
    Value value;
  };
  std::vector<Kept> values_;
};

}  // namespace spoonbill
