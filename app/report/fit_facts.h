// What there is to say about a fit.
#pragma once

#include "app/files/scan_file.h"
#include "app/report/fact_sheet.h"
#include "engine/fitting/fit_scan.h"

namespace spoonbill {

// Of all bodies together: the largest, the 95th percentile and the mean of the distances of their points but
// strays.
Deviation deviation_of_all(const ScanFit& fit);

// The scan as it was read and what of it was used; then each body with its errors, and those of all.
void add_scan_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit);
void add_fit_facts(FactSheet& facts, const ScanFit& fit);

}  // namespace spoonbill
