#pragma once

// How an InstanceState remembers what was done to it while diffs are pending. Included by its own sources, and by nothing else.

#include "core/base/guard.hpp"
#include "core/state/pending_diff.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace thicket {

/// A call that changed a state, or would have if the state had been another.
struct StateStep {
	enum class Kind : std::uint8_t { remove, restore, place, move, set_data, advance, claim, release_claims };

	Kind kind = Kind::remove;
	std::uint64_t id = 0;
	std::uint64_t to = 0; ///< `move`: the id that the instance has then. `claim`: the stamp.
	double number = 0.0;  ///< `remove`: until when. `advance`: seconds. `claim`: meters a cell is wide.
	std::shared_ptr<const AddedInstance> instance{};
	std::vector<std::uint8_t> data{};
	std::vector<std::uint64_t> restored{}; ///< By `advance`: all that may be.
};

struct InstanceState::Journal {
	std::deque<std::shared_ptr<PendingDiff>> diffs; ///< One at least.
	std::deque<StateStep> steps;                    ///< Since the first was queued.

	/// Notes steps in a journal, if there is one, and forgets them in the end unless they are kept.
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

		/// `make()` gives the step. Throws std::bad_alloc.
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

	/// Does `work()`, which gives a status, with its step noted in a journal, if there is one. Where there is no memory for that, nothing
	/// is done, and the status names what was asked for; a step whose work is refused is forgotten.
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
