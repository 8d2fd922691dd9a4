// Forces with which contacts pushed at the end of the last tick. The forces of the next tick start from them.
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

// Forces of contacts, N: numbers along the contacts' normals, or vectors. Call add() for all forces, then
// sort(), then find(). Has one owner, on one thread. Allocates only in its constructor.
template <class Force>
class KeptForces {
 public:
  explicit KeptForces(std::size_t capacity) { forces_.reserve(capacity); }

  void clear() { forces_.clear(); }
  void add(const ContactKey& key, const Force& force_n) { forces_.push_back({key, force_n}); }
  void sort() {
    std::sort(forces_.begin(), forces_.end(), [](const Kept& a, const Kept& b) { return a.key < b.key; });
  }
  // Returns the force of a contact, or `none` if it did not push.
  Force find(const ContactKey& key, const Force& none) const {
    const auto at = std::lower_bound(forces_.begin(), forces_.end(), key,
                                     [](const Kept& kept, const ContactKey& k) { return kept.key < k; });
    return at != forces_.end() && at->key == key ? at->force_n : none;
  }

 private:
  struct Kept {
    ContactKey key;
    Force force_n;
  };
  std::vector<Kept> forces_;
};

}  // namespace spoonbill
