#pragma once
#include <vector>

#include "batch/registration/registration_unit.hpp"
#include "batch/registration/scan_to_scan.hpp"

namespace hybrid::batch {

// Of a model of unknown scale ([register] scale = "free") all scans have one scale: scanners measure in
// metres. A scan that does not show it, whose scale is its landmarks' then, takes the median of those that do
// (and of poses that are fixed), and is refined anew with this; as it was where it then lies on the model
// less well. Sets ScanRegistration::scale_of_others. Nothing where no scan shows it.
void share_scale(device::Queue& queue, const stages::ProxyModel& model, const StageOptions& options,
                 const std::vector<ScanProduct>& products, Registrations& registrations);

}  // namespace hybrid::batch
