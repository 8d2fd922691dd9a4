// The report of the fit command: facts, notes, and the cloud of coloured errors.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/files/scan_file.h"
#include "app/report/fact_sheet.h"
#include "engine/base/file.h"
#include "engine/base/result.h"
#include "engine/fitting/fit_scan.h"

namespace spoonbill {

// Returns the maximum, the 95th percentile and the mean of the distances between the points of all bodies and
// the fitted surfaces. Stray points are not counted.
Deviation deviation_of_all(const ScanFit& fit);

// Returns a note for a scan that is implausibly small or large, whose unit may be wrong.
std::optional<std::string> find_size_note(const ScanFile& file, const ScanFit& fit);

// Returns a note for a scan that the surface does not follow closely, because the scan has a handle or a
// hole, or more detail than the control points can follow.
std::optional<std::string> find_detail_note(const ScanFit& fit);

// Returns notes on bodies that miss the tolerance or fold, on normals that were flipped, and on connected
// components of the scan that were skipped or capped. A tolerance of 0 means that there is no tolerance.
std::vector<std::string> find_fit_shortcomings(const ScanFit& fit, double tolerance_m);

// Adds a line for the points that belong to no body: outliers, points in specks and points on other islands.
// The line has their numbers and their fraction of the distinct points. Must be called before all other facts
// are added, because the other facts describe only the points of the bodies.
void add_left_out_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit);

// Adds the unit and size of the scan, the distance within which vertices were joined, and the number of
// points used.
void add_scan_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit);

// Adds each body with its errors, whether 95 % of the whole scan is within the tolerance, and in the JSON the
// errors of all bodies together.
void add_fit_facts(FactSheet& facts, const ScanFit& fit, double tolerance_m);

// Writes a binary PLY file in metres. Its points are those of the scan or, if the scan is a coarse mesh,
// samples all over the mesh. Each point has its distance_mm and a colour from dark violet (0) through green
// to yellow (`full_m` and beyond).
Status write_error_cloud(const ScanFit& fit, double full_m, const std::filesystem::path& file,
                         const OutputOptions& options = {});

}  // namespace spoonbill
