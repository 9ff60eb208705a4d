#pragma once

#include "core/query/instance_query.hpp"

#include <limits>
#include <vector>

namespace thicket {

/// A possible answer of a search for the first instance, along a ray or by distance.
struct Candidate {
	double at = 0.0; ///< Candidates with smaller values come first.
	PlacedInstance instance;
};

/// The candidates that a search for the first instance has found. Calls the filter's `accepts` in the order of `at`,
/// layer and id, and only for candidates that come before everything that is still to be searched.
class Candidates {
public:
	explicit Candidates(const QueryFilter &filter) : filter_(filter) {}

	/// A candidate beyond this value cannot be the answer.
	double limit() const { return limit_; }

	void add(const Candidate &candidate);

	/// Searches for the answer among the candidates before `until`. All candidates that are added later must not come
	/// before `until`. Returns true if the answer is found.
	bool settle(double until);

	/// Valid after `settle` returned true.
	const Candidate &answer() const { return waiting_.back(); }

private:
	const QueryFilter &filter_;
	std::vector<Candidate> waiting_; ///< A heap with the first on top; without `accepts`, only the first.
	double limit_ = std::numeric_limits<double>::infinity();
};

} // namespace thicket
