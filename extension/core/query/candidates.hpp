#pragma once

#include "core/query/instance_query.hpp"

#include <limits>
#include <vector>

namespace thicket {

/// What may be the answer of a search for the first: on a ray, or by distance.
struct Candidate {
	double at = 0.0; ///< The smaller, the earlier.
	PlacedInstance instance;
};

/// What such a search has found so far. Asks the filter's `accepts` in the order of `at`, layer and id, and only for
/// those that come before all that is still to be looked at.
class Candidates {
public:
	explicit Candidates(const QueryFilter &filter) : filter_(filter) {}

	/// What comes later than this is no answer.
	double limit() const { return limit_; }

	void add(const Candidate &candidate);

	/// Looks for the answer among those before `until`, where everything that was not added yet comes later. True if
	/// there is one.
	bool settle(double until);

	/// After `settle` was true.
	const Candidate &answer() const { return waiting_.back(); }

private:
	const QueryFilter &filter_;
	std::vector<Candidate> waiting_; ///< A heap, the first on top; without `accepts`, the first alone.
	double limit_ = std::numeric_limits<double>::infinity();
};

} // namespace thicket
