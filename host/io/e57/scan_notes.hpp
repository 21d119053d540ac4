#pragma once
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/e57/e57_model.hpp"
#include "io/e57/record_reader.hpp"
#include "io/e57/scan_samples.hpp"

// What a Scan says of an E57 scan besides its samples, in the order in which a reader comes to know it.
namespace hybrid::io {

// The file's own: pose, notes; the origin.
void describe_e57_scan(const E57Scan& source, const ScanSamples& samples, const E57RecordReader& reader,
                       Scan& scan);

SampleTally sum_of(const std::vector<SampleTally>& in_order);
// What is no return, and why; damaged pages. Throws ErrorKind::input for absurd coordinates, not in salvage.
void note_tallies(const std::string& where, const SampleTally& sum, const E57RecordReader& reader,
                  bool salvage, Scan& scan);
// Damaged pages that were met, and how many of the reader's points are lost: what became of them.
void add_damage_notes(const E57RecordReader& reader, std::uint64_t lost, const std::string& fate,
                      std::vector<std::string>& notes);
// What is not used, limits, the origin.
void add_e57_notes(const E57Scan& source, const ScanColumns& columns, std::uint64_t count, Scan& scan);

// By its file: name, coordinate system, limits of intensity.
void name_e57_scan(const std::string& file, const E57Contents& contents, std::size_t index, Scan& scan);

}  // namespace hybrid::io
