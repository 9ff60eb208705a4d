#include "core/query/candidates.hpp"

#include <algorithm>
#include <tuple>

namespace thicket {

namespace {

/// Defines the order of a heap with the first candidate on top.
bool later(const Candidate &a, const Candidate &b) {
	return std::tie(a.at, a.instance.layer, a.instance.id) > std::tie(b.at, b.instance.layer, b.instance.id);
}

} // namespace

void Candidates::add(const Candidate &candidate) {
	if (filter_.accepts) {
		waiting_.push_back(candidate);
		std::push_heap(waiting_.begin(), waiting_.end(), later);
	} else if (waiting_.empty() || later(waiting_.front(), candidate)) {
		// Without `accepts`, only the first candidate can be the answer.
		waiting_.assign(1, candidate);
		limit_ = candidate.at;
	}
}

bool Candidates::settle(double until) {
	while (!waiting_.empty() && waiting_.front().at < until) {
		std::pop_heap(waiting_.begin(), waiting_.end(), later);
		if (!filter_.accepts || filter_.accepts(waiting_.back().instance)) {
			return true;
		}
		waiting_.pop_back();
	}
	return false;
}

} // namespace thicket
