#pragma once

// Records the calls made on an InstanceState while diffs are pending. Only the sources of
// InstanceState include this file.

#include "core/base/guard.hpp"
#include "core/state/pending_diff.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace thicket {

/// A recorded call. It may have had no effect, but can have one when it is repeated on top of a
/// diff.
struct StateStep {
	enum class Kind : std::uint8_t { remove, restore, place, move, set_data, advance, claim, release_claims };

	Kind kind = Kind::remove;
	std::uint64_t id = 0;
	std::uint64_t to = 0; ///< For `move`, the ID after the move. For `claim`, the stamp.
	/// For `remove`, the clock time of regrowth. For `advance`, the seconds. For `claim`, the cell
	/// width in meters.
	double number = 0.0;
	std::int32_t count = 1; ///< For `claim`, the number of cells that belong together.
	std::shared_ptr<const AddedInstance> instance{};
	std::vector<std::uint8_t> data{};
	std::vector<std::uint64_t> restored{}; ///< Ids that `advance` may have restored.
};

struct InstanceState::Journal {
	std::deque<std::shared_ptr<PendingDiff>> diffs; ///< Diffs that are not finished. Never empty.
	std::deque<StateStep> steps;                    ///< Calls made since the first diff was queued.

	/// Records steps in a journal, if there is one. The destructor removes them again unless
	/// `keep_if(true)` was called.
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

		/// Records the step that `make()` returns. Throws std::bad_alloc.
		template <typename Make>
		void record(const Make &make) {
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

	/// Records a step in a journal, if there is one, and returns the status of `work()`. If memory
	/// for the step runs out, the function returns a status that names the allocation, without
	/// calling `work`. If `work` fails, the step is removed.
	template <typename Make, typename Work>
	static Status noting(Journal *journal, const char *asked_for, double value, const Make &make, const Work &work) {
		Noting noting(journal);
		Status status;
		if (journal != nullptr) {
			status = guarded(asked_for, value, [&] { noting.record(make); });
		}
		status = status.ok() ? work() : status;
		noting.keep_if(status.ok());
		return status;
	}
};

} // namespace thicket
