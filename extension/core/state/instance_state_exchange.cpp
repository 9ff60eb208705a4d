// What an InstanceState gives to others and takes from them.

#include "core/state/instance_state_content.hpp"

#include "core/base/bytes.hpp"
#include "core/base/guard.hpp"

#include <algorithm>

namespace thicket {

Status InstanceState::save(std::vector<std::uint8_t> &r_bytes) const {
	return guarded_answer(
			"state", static_cast<double>(content_->size()), r_bytes, [&] { write(content_->whole_record(), r_bytes); });
}

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
	return guarded("data", static_cast<double>(bytes.size()), [&] { content_->start_from(record, r_changes); });
}

Status InstanceState::diff_since(std::uint64_t revision, std::vector<std::uint8_t> &r_bytes) const {
	const bool known = revision <= content_->revision && content_->log.knows(revision);
	return guarded_answer("state", static_cast<double>(content_->size()), r_bytes, [&] {
		write(known ? content_->record_of(content_->log.since(revision), false) : content_->whole_record(), r_bytes);
	});
}

Status InstanceState::diff_of(std::span<const std::uint64_t> ids, std::vector<std::uint8_t> &r_bytes) const {
	return guarded_answer("ids", static_cast<double>(ids.size()), r_bytes, [&] {
		std::vector<std::uint64_t> once(ids.begin(), ids.end());
		std::ranges::sort(once);
		once.erase(std::unique(once.begin(), once.end()), once.end());
		std::erase(once, IdTable::none);
		write(content_->record_of(std::move(once), false), r_bytes);
	});
}

Status InstanceState::apply(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes) {
	StateRecord record;
	if (const Status status = read(bytes, record); !status.ok()) {
		return status;
	}
	if (const Status status = content_->check_stamps(record, record.whole); !status.ok()) {
		return status;
	}
	return guarded("data", static_cast<double>(bytes.size()), [&] {
		content_->follow(record, r_changes);
		content_->time = std::max(content_->time, record.time);
	});
}

Status InstanceState::merge(const InstanceState &other, std::vector<InstanceChange> &r_changes) {
	return guarded("other", static_cast<double>(other.content_->size()),
			[&] { return content_->take_in(other.content_->whole_record(), r_changes); });
}

Status InstanceState::Content::take_in(const StateRecord &record, std::vector<InstanceChange> &r_changes) {
	if (const Status status = check_stamps(record, false); !status.ok()) {
		return status;
	}
	make_room_for_stamps(record);
	const auto each = [&](const auto &use) {
		record.for_each([&](std::uint64_t id, const Entry &theirs) {
			Entry both = entry(id);
			if (theirs.removed) {
				const bool for_ever = theirs.until == 0.0 || (both.removed && both.until == 0.0);
				both.until = for_ever ? 0.0 : std::max(both.until, theirs.until);
				both.removed = true;
			}
			both.instance = both.instance != nullptr ? both.instance : theirs.instance;
			both.data = theirs.data.empty() ? both.data : theirs.data;
			use(id, both);
		});
	};
	change_all(each, r_changes);
	take_stamps(record);
	time = std::max(time, record.time);
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
