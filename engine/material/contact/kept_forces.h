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

// Forces of contacts. Call add() for all forces, then sort(), then find(). Has one owner, on one thread.
// Allocates only in its constructor.
class KeptForces {
 public:
  explicit KeptForces(std::size_t capacity) { forces_.reserve(capacity); }

  void clear() { forces_.clear(); }
  void add(const ContactKey& key, double force_n) { forces_.push_back({key, force_n}); }
  void sort() {
    std::sort(forces_.begin(), forces_.end(), [](const Force& a, const Force& b) { return a.key < b.key; });
  }
  // Returns the force of a contact in N, or 0 if it did not push.
  double find(const ContactKey& key) const {
    const auto at = std::lower_bound(forces_.begin(), forces_.end(), key,
                                     [](const Force& force, const ContactKey& k) { return force.key < k; });
    return at != forces_.end() && at->key == key ? at->force_n : 0.0;
  }

 private:
  struct Force {
    ContactKey key;
    double force_n;
  };
  std::vector<Force> forces_;
};

}  // namespace spoonbill
