#pragma once

#include "core/base/status.hpp"
#include "core/rules/curve_table.hpp"

#include <memory>
#include <stdexcept>
#include <vector>

namespace thicket::analysis {

/// Throws std::logic_error, which fails a test and ends a program, if a call was unexpectedly refused.
inline void expect(const Status &status) {
	if (!status.ok()) {
		throw std::logic_error(describe(status));
	}
}

/// A curve through samples (0 to 1, at least two) that are evenly spaced from `min` to `max`. Throws if they are
/// refused.
inline std::shared_ptr<const CurveTable> curve_table(double min, double max, const std::vector<float> &samples) {
	auto table = std::make_shared<CurveTable>();
	expect(table->set(min, max, samples));
	return table;
}

} // namespace thicket::analysis
