#pragma once

#include "core/query/instance_query.hpp"

#include <limits>
#include <vector>

namespace thicket {

/// A candidate in a search for the first instance, either along a ray or by distance.
struct Candidate {
	/// The sort key: squared distance, or fraction of the ray's length. The smallest comes first.
	double at = 0.0;
	PlacedInstance instance;
};

/// The candidates found so far in a search for the first instance. The filter's `accepts` is called
/// in the order of `at`, layer and ID. It is called only for candidates that come before everything
/// that has not been searched yet.
class Candidates {
public:
	explicit Candidates(const QueryFilter &filter) : filter_(filter) {}

	/// Returns the largest `at` with which a candidate can still be the answer.
	double limit() const { return limit_; }

	void add(const Candidate &candidate);

	/// Searches for the answer among the candidates with `at` below `until`. Candidates added later
	/// must not be below `until`. Returns true if the answer was found.
	bool settle(double until);

	/// Returns the answer. Call this function only after `settle` has returned true.
	const Candidate &answer() const { return waiting_.back(); }

private:
	const QueryFilter &filter_;
	/// A heap with the first candidate on top. Without `accepts`, it contains only the first.
	std::vector<Candidate> waiting_;
	double limit_ = std::numeric_limits<double>::infinity();
};

} // namespace thicket
