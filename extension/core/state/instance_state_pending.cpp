// This file applies diffs on a worker thread and takes over the results.

#include "core/base/guard.hpp"
#include "core/state/instance_state_content.hpp"
#include "core/state/state_step.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

namespace {

using Kind = StateStep::Kind;

/// Appends the changes to report for an ID whose content changes from `from` to `to`.
void add_difference(std::uint64_t id, const StateRecord::Entry &from, const StateRecord::Entry &to,
		std::vector<InstanceChange> &r_changes) {
	const auto is_equal = [](const AddedInstance *left, const AddedInstance *right) {
		return left == right || (left != nullptr && right != nullptr && *left == *right);
	};
	if (from.removed != to.removed) {
		r_changes.push_back({id, to.removed ? InstanceChangeKind::removed : InstanceChangeKind::restored, {}});
	}
	const bool moves = from.instance != nullptr && to.instance != nullptr;
	if (!is_equal(from.instance, to.instance)) {
		if (from.instance != nullptr) {
			r_changes.push_back({id, moves ? InstanceChangeKind::left : InstanceChangeKind::removed, *from.instance});
		}
		if (to.instance != nullptr) {
			r_changes.push_back({id, moves ? InstanceChangeKind::moved : InstanceChangeKind::added, *to.instance});
		}
	}
	const bool is_removed_with_instance = is_added(id) && to.instance == nullptr;
	if (!is_removed_with_instance && !std::ranges::equal(from.data, to.data)) {
		r_changes.push_back({id, InstanceChangeKind::data, to.instance != nullptr ? *to.instance : AddedInstance()});
	}
}

void add_ids(const StateStep &step, std::vector<std::uint64_t> &r_ids) {
	if (step.kind == Kind::claim || step.kind == Kind::release_claims) {
		return;
	}
	if (step.kind != Kind::advance) {
		r_ids.push_back(step.id);
	}
	if (step.kind == Kind::move) {
		r_ids.push_back(step.to);
	}
	r_ids.insert(r_ids.end(), step.restored.begin(), step.restored.end());
}

} // namespace

void PendingDiff::start_from(InstanceState base, const ChangeLog &log, std::uint64_t revision) noexcept {
	base_ = std::move(base);
	revision_ = revision;
	const Status status = guarded("changes", static_cast<double>(log.size()), [&] { log_ = log; });
	if (!status.ok()) {
		log_.start_at(revision);
	}
}

void PendingDiff::work() {
	status_ = guarded("data", static_cast<double>(bytes_.size()), [this]() -> Status {
		next_ = base_->share();
		InstanceState::Content &content = *next_->content_;
		base_revision_ = content.revision;
		content.complete();
		content.cancel = &cancel_;
		const Status status = next_->apply(bytes_, changes_.list, limits_);
		content.cancel = nullptr;
		if (cancel_) {
			return {ErrorCode::cancelled, "data"};
		}
		if (status.ok()) {
			log_.compact_before(content.log, content.size());
		}
		return status;
	});
}

InstanceState::InstanceState(std::unique_ptr<Content> content) : content_(std::move(content)) {}

InstanceState InstanceState::share() { return InstanceState(content_->share()); }

Status InstanceState::complete() {
	return guarded("state", static_cast<double>(content_->size()), [this] { content_->complete(); });
}

Status InstanceState::queue_diff(
		std::span<const std::uint8_t> bytes, std::shared_ptr<PendingDiff> &r_diff, const DiffLimits &limits) {
	return guarded("data", static_cast<double>(bytes.size()), [&] {
		const bool is_first = journal_ == nullptr;
		auto journal = is_first ? std::make_unique<Journal>() : nullptr;
		Journal &queue = is_first ? *journal : *journal_;
		const auto diff = std::make_shared<PendingDiff>(bytes, limits);
		if (is_first) {
			diff->start_from(share(), content_->log, content_->revision);
		}
		diff->steps_before_ = queue.steps.size();
		queue.diffs.push_back(diff);
		journal_ = is_first ? std::move(journal) : std::move(journal_);
		r_diff = diff;
	});
}

std::shared_ptr<PendingDiff> InstanceState::pending_diff() const {
	return journal_ != nullptr ? journal_->diffs.front() : nullptr;
}

Status InstanceState::finish_pending_diff(StateChanges &r_changes) {
	const std::shared_ptr<PendingDiff> first = journal_->diffs.front();
	const auto guarded_by_size = [&](const auto &work) {
		return guarded("data", static_cast<double>(first->bytes_.size()), work);
	};
	Status status = first->status_;
	if (status.ok()) {
		status = guarded_by_size([&] { return take_over(*first, r_changes); });
	}
	if (!status.ok()) {
		const Status discarded = guarded_by_size([&] { discard_first(*first); });
		// If the content for the next diff cannot be prepared, all pending diffs fail.
		for (const std::shared_ptr<PendingDiff> &diff : journal_->diffs) {
			diff->status_ = discarded.ok() ? diff->status_ : discarded;
		}
	}
	journal_->diffs.pop_front();
	if (journal_->diffs.empty()) {
		journal_.reset();
		return status;
	}
	const std::size_t applied_count = journal_->diffs.front()->steps_before_;
	journal_->steps.erase(
			journal_->steps.begin(), journal_->steps.begin() + static_cast<std::ptrdiff_t>(applied_count));
	for (const std::shared_ptr<PendingDiff> &diff : journal_->diffs) {
		diff->steps_before_ -= applied_count;
	}
	return status;
}

/// Takes the diff's result and repeats on it the calls made since the diff was queued. The result
/// then becomes the content of this state.
Status InstanceState::take_over(PendingDiff &diff, StateChanges &r_changes) {
	InstanceState &next = *diff.next_;
	const std::shared_ptr<PendingDiff> second = journal_->diffs.size() > 1 ? journal_->diffs[1] : nullptr;
	std::optional<InstanceState> second_base;
	std::vector<std::uint64_t> touched;
	std::vector<InstanceChange> changes;
	for (std::size_t index = 0; index <= journal_->steps.size(); ++index) {
		if (second != nullptr && index == second->steps_before_) {
			second_base = next.share();
		}
		if (index < journal_->steps.size()) {
			StateStep &step = journal_->steps[index];
			const Status status = next.repeat(step, changes);
			throw_if_out_of_memory(status);
			if (!status.ok()) {
				return status;
			}
			for (const InstanceChange &change : changes) {
				step.restored.push_back(change.id); // The diffs queued after this one need these IDs.
			}
			changes.clear();
			add_ids(step, touched);
		}
	}
	std::ranges::sort(touched);
	touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
	for (const std::uint64_t id : touched) {
		add_difference(id, content_->entry(id), next.content_->entry(id), diff.changes_.replacements);
	}
	diff.changes_.overruled = std::move(touched);

	// The statements below cannot fail.
	next.content_->take_history(*content_, diff.log_, diff.revision_, diff.base_revision_);
	content_.swap(next.content_);
	r_changes = std::move(diff.changes_);
	if (second != nullptr) {
		second->start_from(std::move(*second_base), content_->log, content_->revision);
	}
	return {};
}

/// Discards the first pending diff without applying it, and prepares the content for the next diff.
void InstanceState::discard_first(PendingDiff &diff) {
	if (journal_->diffs.size() < 2) {
		return;
	}
	PendingDiff &second = *journal_->diffs[1];
	if (!diff.base_.has_value()) {
		throw std::bad_alloc();
	}
	diff.base_->content_->complete();
	std::vector<InstanceChange> changes;
	for (std::size_t index = 0; index < second.steps_before_; ++index) {
		throw_if_out_of_memory(diff.base_->repeat(journal_->steps[index], changes));
	}
	second.start_from(diff.base_->share(), content_->log, content_->revision);
}

/// Repeats a call that was recorded while a diff was pending. The state may have applied the diff
/// (`take_over`) or not (`discard_first`).
Status InstanceState::repeat(const StateStep &step, std::vector<InstanceChange> &r_changes) {
	switch (step.kind) {
		case Kind::remove: return remove(step.id, step.number).status;
		case Kind::restore: return restore(step.id).status;
		case Kind::place: return put(step.id, *step.instance).status;
		case Kind::move: return guarded("instance", 1.0, [&] { put_for(step.id, step.to, *step.instance, r_changes); });
		case Kind::set_data: {
			const Status status = set_data(step.id, step.data);
			return status.code == ErrorCode::missing ? Status() : status; // The diff deleted the instance.
		}
		case Kind::advance: return advance(step.number, r_changes);
		case Kind::claim: return claim(static_cast<std::uint16_t>(step.id), step.to, step.number, step.count);
		case Kind::release_claims: release_claims(); return {};
	}
	return {};
}

} // namespace thicket
