#pragma once

#include "core/base/status.hpp"
#include "core/rules/curve_table.hpp"

#include <memory>
#include <stdexcept>
#include <vector>

namespace thicket::analysis {

/// Throws std::logic_error if `status` is an error. The exception fails a test and terminates a
/// program.
inline void expect(const Status &status) {
	if (!status.ok()) {
		throw std::logic_error(describe(status));
	}
}

/// Returns a curve through at least two samples (0 to 1) that are evenly spaced from `min` to
/// `max`. Throws std::logic_error if the arguments are invalid.
inline std::shared_ptr<const CurveTable> curve_table(double min, double max, const std::vector<float> &samples) {
	auto table = std::make_shared<CurveTable>();
	expect(table->set(min, max, samples));
	return table;
}

} // namespace thicket::analysis
