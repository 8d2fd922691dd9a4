// exp and log with the same bits on every processor. The C library's results may differ, because it selects
// its instructions at run time.
#pragma once

namespace spoonbill {

// Exponential function with the same bits on every processor, unlike the C library's. Accurate to about two
// units in the last place. Returns 0 if x is at most -700; x must not be above 700.
double stable_exp(double x);

// Natural logarithm of a normal x > 0, with the same bits on every processor. Accurate to about two units in
// the last place.
double stable_log(double x);

}  // namespace spoonbill
