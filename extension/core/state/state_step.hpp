#pragma once

// How an InstanceState records the calls made while diffs are pending. Included only by its own sources.

#include "core/base/guard.hpp"
#include "core/state/pending_diff.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace thicket {

/// A call that changed a state, or that would have changed a different one.
struct StateStep {
	enum class Kind : std::uint8_t { remove, restore, place, move, set_data, advance, claim, release_claims };

	Kind kind = Kind::remove;
	std::uint64_t id = 0;
	std::uint64_t to = 0; ///< `move`: the id after the move. `claim`: the stamp.
	double number = 0.0;  ///< `remove`: until when. `advance`: seconds. `claim`: cell width in meters.
	std::shared_ptr<const AddedInstance> instance{};
	std::vector<std::uint8_t> data{};
	std::vector<std::uint64_t> restored{}; ///< By `advance`: all candidates.
};

struct InstanceState::Journal {
	std::deque<std::shared_ptr<PendingDiff>> diffs; ///< At least one.
	std::deque<StateStep> steps;                    ///< Since the first diff was queued.

	/// Records steps in a journal, if one exists, and removes them at the end of scope unless they are kept.
	class Noting {
	public:
		explicit Noting(Journal *journal) :
				journal_(journal), before_(journal != nullptr ? journal->steps.size() : 0) {}
		~Noting() {
			while (journal_ != nullptr && journal_->steps.size() > before_) {
				journal_->steps.pop_back();
			}
		}
		Noting(const Noting &) = delete;
		Noting &operator=(const Noting &) = delete;

		/// `make()` returns the step. Throws std::bad_alloc.
		template <typename Make>
		void note(const Make &make) {
			if (journal_ != nullptr) {
				journal_->steps.push_back(make());
			}
		}

		StateStep *last() { return journal_ != nullptr ? &journal_->steps.back() : nullptr; }

		void keep_if(bool done) { journal_ = done ? nullptr : journal_; }

	private:
		Journal *journal_;
		std::size_t before_;
	};

	/// Calls `work()`, which returns a status, and records its step in a journal, if there is one. If memory does not suffice to record
	/// it, does nothing and returns a status that names the allocation. Forgets the step if its work is refused.
	template <typename Make, typename Work>
	static Status noting(Journal *journal, const char *asked_for, double value, const Make &make, const Work &work) {
		Noting noting(journal);
		Status status;
		if (journal != nullptr) {
			status = guarded(asked_for, value, [&] { noting.note(make); });
		}
		status = status.ok() ? work() : status;
		noting.keep_if(status.ok());
		return status;
	}
};

} // namespace thicket
