// What there is to say about a fit.
#pragma once

#include <optional>
#include <string>

#include "app/files/scan_file.h"
#include "app/report/fact_sheet.h"
#include "engine/fitting/fit_scan.h"

namespace spoonbill {

// Of all bodies together: the largest, the 95th percentile and the mean of the distances of their points but
// strays.
Deviation deviation_of_all(const ScanFit& fit);

// Of a scan smaller or larger than anything that is scanned: its unit may be another.
std::optional<std::string> size_remark(const ScanFile& file, const ScanFit& fit);

// Of a scan that the surface does not follow closely, which is then no shape that one surface lays out, or
// has more detail than control points.
std::optional<std::string> looseness_remark(const ScanFit& fit);

// The scan as it was read and what of it was used; then each body with its errors, and those of all.
void add_scan_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit);
void add_fit_facts(FactSheet& facts, const ScanFit& fit);

}  // namespace spoonbill
