// What there is to say about a fit.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

// Whether 95 % of each body's points but strays lie within the tolerance; nothing where none was asked for.
std::optional<bool> is_within(const ScanFit& fit, double tolerance_m);

// Of bodies that are not within the tolerance that was asked for, that fold, of normals turned, of islands
// left out or capped.
std::vector<std::string> shortcoming_remarks(const ScanFit& fit, double tolerance_m);

// The scan as it was read and what of it was used; then each body with its errors, and those of all.
void add_scan_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit);
void add_fit_facts(FactSheet& facts, const ScanFit& fit, double tolerance_m);

}  // namespace spoonbill
