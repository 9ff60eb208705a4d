// What an InstanceState gives to others and takes from them.

#include "core/state/instance_state_content.hpp"

#include "core/base/bytes.hpp"

#include <algorithm>

namespace thicket {

void InstanceState::save(std::vector<std::uint8_t> &r_bytes) const { write(content_->whole_record(), r_bytes); }

Status InstanceState::load(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes) {
	StateRecord record;
	if (const Status status = read(bytes, record); !status.ok()) {
		return status;
	}
	if (!record.whole) {
		return {ErrorCode::corrupt, "data"};
	}
	if (const Status status = content_->check_stamps(record, true); !status.ok()) {
		return status;
	}
	content_->start_from(record, r_changes);
	return {};
}

void InstanceState::diff_since(std::uint64_t revision, std::vector<std::uint8_t> &r_bytes) const {
	const bool known = revision <= content_->revision && content_->log.knows(revision);
	write(known ? content_->record_of(content_->log.since(revision), false) : content_->whole_record(), r_bytes);
}

Status InstanceState::apply(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes) {
	StateRecord record;
	if (const Status status = read(bytes, record); !status.ok()) {
		return status;
	}
	if (const Status status = content_->check_stamps(record, record.whole); !status.ok()) {
		return status;
	}
	content_->follow(record, r_changes);
	content_->time = std::max(content_->time, record.time);
	return {};
}

Status InstanceState::merge(const InstanceState &other, std::vector<InstanceChange> &r_changes) {
	const StateRecord record = other.content_->whole_record();
	if (const Status status = content_->check_stamps(record, false); !status.ok()) {
		return status;
	}
	record.for_each([this, &r_changes](std::uint64_t id, const Content::Entry &theirs) {
		Content::Entry both = content_->entry(id);
		if (theirs.removed) {
			const bool for_ever = theirs.until == 0.0 || (both.removed && both.until == 0.0);
			both.until = for_ever ? 0.0 : std::max(both.until, theirs.until);
			both.removed = true;
		}
		both.instance = both.instance != nullptr ? both.instance : theirs.instance;
		both.data = theirs.data.empty() ? both.data : theirs.data;
		content_->change(id, both, r_changes);
	});
	content_->take_stamps(record);
	content_->time = std::max(content_->time, record.time);
	return {};
}

std::uint64_t InstanceState::digest() const {
	StateRecord record = content_->whole_record();
	record.time = 0.0;
	for (auto &[layer, stamp] : record.stamps) {
		stamp = 0;
	}
	std::vector<std::uint8_t> bytes;
	write(record, bytes);
	return checksum(bytes);
}

} // namespace thicket
