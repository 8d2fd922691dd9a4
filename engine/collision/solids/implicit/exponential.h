// exp and log with the same bits on every processor: the C library's choose their instructions by it.
#pragma once

namespace spoonbill {

// To about two units in the last place. 0 below -700, not for more than 700.
double stable_exp(double x);

// To about two units in the last place, for normal x > 0.
double stable_log(double x);

}  // namespace spoonbill
