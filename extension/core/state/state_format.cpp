#include "core/state/state_format.hpp"

#include "core/base/bytes.hpp"
#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/state/added_numbers.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

// Format 2. Numbers are little-endian. A count is written with 7 bits per byte, the lowest first,
// and the highest bit set in all bytes except the last. A list is written as in id_codec.hpp; IDs
// in it are codes:
//   "TSTA", u32 format;
//   u8 kind: bit 0 for some IDs instead of a complete state, bit 1 for a named sender;
//   f64 clock in seconds;
//   only for a named sender: u64 name, count: its revision; for some IDs also count: the number of revisions covered;
//   count of layers; for each, ascending: count: the layer, u64 stamp;
//   six counts: the sizes of the lists that follow;
//   list of removed points, list of the indices in it of those that grow again, f64 time of each of these;
//   list of points that are not removed, list of hand-placed IDs that were deleted;
//   list of hand-placed IDs; for each: u8 mesh, 3 f64 position, 9 f32 basis, column by column, f64 time of placing;
//   list of IDs with data; for each: count of its bytes, the bytes, f64 time of setting;
//   u64 FNV-1a of all bytes before it.
// Format 1 has only kinds 0 and 1, no sender, and no times of placing and setting. Its number of
// layers is stored minus one in a u16, or as 0xffff for none. A layer is a u16, each list is
// preceded by its size as a u32, and a count of bytes is a u32. Each content has exactly one valid
// encoding. Loading and saving therefore reproduces the same bytes.

namespace thicket {

namespace {

constexpr std::uint32_t magic = 0x41545354;
constexpr std::size_t checksum_size = 8;
constexpr std::uint16_t no_layers = 0xffff;
constexpr std::uint8_t partial_bit = 1;
constexpr std::uint8_t named_bit = 2;
constexpr std::size_t instance_size = 1 + 3 * 8 + 9 * 4;
constexpr std::size_t min_data_size = 1 + 1;

constexpr Status corrupt{ErrorCode::corrupt, "data"};

void append_time(double time, std::vector<std::uint8_t> &r_bytes) {
	append(r_bytes, std::bit_cast<std::uint64_t>(time));
}

double take_time(ByteReader &r_bytes) { return std::bit_cast<double>(r_bytes.take<std::uint64_t>()); }

bool is_time(double time) { return check_range("time", time, 0.0, max_state_time).ok() && !std::signbit(time); }

void append_count(std::uint64_t count, std::vector<std::uint8_t> &r_bytes) {
	for (; count >= 0x80; count >>= 7) {
		r_bytes.push_back(static_cast<std::uint8_t>(count | 0x80));
	}
	r_bytes.push_back(static_cast<std::uint8_t>(count));
}

/// Reads a count. Accepts a count with superfluous bytes, which `read` rejects later, because
/// `write` would use fewer bytes.
std::uint64_t take_count(ByteReader &r_bytes) {
	std::uint64_t count = 0;
	std::uint8_t byte = 0x80;
	for (int shift = 0; shift < 64 && (byte & 0x80) != 0; shift += 7) {
		byte = r_bytes.take<std::uint8_t>();
		count |= std::uint64_t{byte & 0x7fU} << shift;
	}
	return count;
}

/// Writes the parts that differ between the formats.
class RecordWriter {
public:
	RecordWriter(std::vector<std::uint8_t> &r_bytes, std::uint32_t format, const std::atomic<bool> *cancel) :
			bytes_(r_bytes), is_former_(format == former_state_format), cancel_(cancel) {}

	void put(const StateRecord &record) {
		std::vector<std::uint64_t> timed;
		for (const auto &[index, time] : record.until) {
			timed.push_back(index);
		}
		put_head(record, timed.size());
		put_list(record.removed);
		put_list(timed);
		for (const auto &[index, time] : record.until) {
			append_time(time, bytes_);
		}
		put_list(record.present);
		put_list(record.removed_placed);
		put_list(record.added);
		for (std::size_t at = 0; at < record.instances.size(); ++at) {
			put_instance(record.instances[at]);
			put_time_of_writing(record.placed_at[at]);
		}
		put_list(record.with_data);
		for (std::size_t at = 0; at < record.data.size(); ++at) {
			put_size(record.data[at].size());
			bytes_.insert(bytes_.end(), record.data[at].begin(), record.data[at].end());
			put_time_of_writing(record.data_at[at]);
		}
	}

private:
	void put_head(const StateRecord &record, std::size_t timed) {
		const bool named = record.origin.name != 0 && !is_former_;
		append(bytes_, static_cast<std::uint8_t>((record.is_complete ? 0 : partial_bit) | (named ? named_bit : 0)));
		append_time(record.time, bytes_);
		if (named) {
			append(bytes_, record.origin.name);
			append_count(record.origin.end, bytes_);
			if (!record.is_complete) {
				append_count(record.origin.end - record.origin.base, bytes_);
			}
		}
		if (is_former_) {
			append(bytes_, static_cast<std::uint16_t>(record.stamps.size() - 1));
		} else {
			append_count(record.stamps.size(), bytes_);
		}
		for (const auto &[layer, stamp] : record.stamps) {
			if (is_former_) {
				append(bytes_, layer);
			} else {
				append_count(layer, bytes_);
			}
			append(bytes_, stamp);
		}
		if (!is_former_) {
			for (const std::size_t size : {record.removed.size(), timed, record.present.size(),
						 record.removed_placed.size(), record.added.size(), record.with_data.size()}) {
				append_count(size, bytes_);
			}
		}
	}

	void put_list(std::span<const std::uint64_t> list) {
		if (is_former_) {
			append(bytes_, static_cast<std::uint32_t>(list.size()));
		}
		append_ascending(list, bytes_, cancel_);
	}

	void put_size(std::size_t size) {
		if (is_former_) {
			append(bytes_, static_cast<std::uint32_t>(size));
		} else {
			append_count(size, bytes_);
		}
	}

	void put_time_of_writing(double time) {
		if (!is_former_) {
			append_time(time, bytes_);
		}
	}

	void put_instance(const AddedInstance &instance) {
		append(bytes_, instance.mesh);
		for_each_number(instance, [this](auto number) {
			if constexpr (sizeof number == 8) {
				append(bytes_, std::bit_cast<std::uint64_t>(number));
			} else {
				append(bytes_, std::bit_cast<std::uint32_t>(number));
			}
		});
	}

	std::vector<std::uint8_t> &bytes_;
	bool is_former_;
	const std::atomic<bool> *cancel_;
};

/// Reads the bytes after the header. Each function returns false for invalid bytes and for content
/// that exceeds the limits.
class RecordReader {
public:
	RecordReader(ByteReader bytes, const StateHeader &header, const DiffLimits &limits,
			const std::atomic<bool> *cancel) : bytes_(bytes), header_(header), limits_(limits), cancel_(cancel) {}

	bool take(StateRecord &r_record) {
		return take_removed(r_record) && take_ids(StateHeader::present, r_record.present) &&
				take_ids(StateHeader::removed_placed, r_record.removed_placed) && take_added(r_record) &&
				take_all_data(r_record) && bytes_.at_end();
	}

	/// Returns the error for the exceeded limit, or ok if no limit was exceeded.
	const Status &refused() const { return refused_; }

private:
	bool is_former() const { return header_.format == former_state_format; }

	bool allows(const Status &status) {
		refused_ = status;
		return status.ok();
	}

	bool take_list(StateHeader::List list, StateRecord::Codes &r_list) {
		const std::uint64_t size = is_former() ? bytes_.take<std::uint32_t>() : header_.sizes[list];
		// On the web, std::size_t has 32 bits, so a larger size means that the bytes are corrupt.
		const auto count = static_cast<std::size_t>(size);
		return bytes_.good() &&
				allows(check_limit("changes", size, limits_.max_changes, "max_changes of diff_limits")) &&
				count == size && take_ascending(bytes_, count, r_list, cancel_);
	}

	bool take_ids(StateHeader::List list, StateRecord::Codes &r_list) {
		if (!take_list(list, r_list)) {
			return false;
		}
		named_ += r_list.size();
		return allows(check_limit("changes", named_, limits_.max_changes, "max_changes of diff_limits"));
	}

	bool take_removed(StateRecord &r_record) {
		std::vector<std::uint64_t> timed;
		if (!take_ids(StateHeader::removed, r_record.removed) || !take_list(StateHeader::timed, timed) ||
				(!timed.empty() && timed.back() >= r_record.removed.size())) {
			return false;
		}
		for (const std::uint64_t index : timed) {
			const double time = take_time(bytes_);
			if (!bytes_.good() || !is_time(time) || time == 0.0) {
				return false;
			}
			r_record.until.emplace_back(index, time);
		}
		return true;
	}

	bool take_added(StateRecord &r_record) {
		if (!take_ids(StateHeader::added, r_record.added) ||
				r_record.added.size() > bytes_.rest().size() / instance_size) {
			return false;
		}
		r_record.instances.resize(r_record.added.size());
		r_record.placed_at.resize(r_record.added.size());
		for (std::size_t at = 0; at < r_record.added.size(); ++at) {
			r_record.instances[at].layer = layer_of(r_record.added[at]);
			if (!take_instance(r_record.instances[at]) || !take_time_of_writing(r_record.placed_at[at])) {
				return false;
			}
		}
		return true;
	}

	bool take_instance(AddedInstance &r_instance) {
		r_instance.mesh = bytes_.take<std::uint8_t>();
		bool signed_zero = false;
		for_each_number(r_instance, [this, &signed_zero](auto &r_number) {
			if constexpr (sizeof r_number == 8) {
				r_number = std::bit_cast<double>(bytes_.take<std::uint64_t>());
			} else {
				r_number = std::bit_cast<float>(bytes_.take<std::uint32_t>());
			}
			signed_zero = signed_zero || (r_number == 0 && std::signbit(r_number));
		});
		return bytes_.good() && !signed_zero && validate(r_instance).ok();
	}

	bool take_time_of_writing(double &r_time) {
		r_time = is_former() ? 0.0 : take_time(bytes_);
		return bytes_.good() && is_time(r_time);
	}

	bool take_all_data(StateRecord &r_record) {
		if (!take_list(StateHeader::with_data, r_record.with_data) ||
				r_record.with_data.size() > bytes_.rest().size() / min_data_size) {
			return false;
		}
		r_record.data.resize(r_record.with_data.size());
		r_record.data_at.resize(r_record.with_data.size());
		for (std::size_t at = 0; at < r_record.data.size(); ++at) {
			if (!take_data(r_record.data[at]) || !take_time_of_writing(r_record.data_at[at])) {
				return false;
			}
		}
		return true;
	}

	bool take_data(std::vector<std::uint8_t> &r_data) {
		const std::uint64_t size = is_former() ? bytes_.take<std::uint32_t>() : take_count(bytes_);
		if (!bytes_.good() || size == 0 || size > max_instance_data ||
				!allows(check_limit("data", size, limits_.max_data_size, "max_data_size of diff_limits"))) {
			return false;
		}
		const std::span<const std::uint8_t> bytes = bytes_.take_bytes(static_cast<std::size_t>(size));
		r_data.assign(bytes.begin(), bytes.end());
		return bytes_.good();
	}

	ByteReader bytes_;
	const StateHeader &header_;
	const DiffLimits &limits_;
	const std::atomic<bool> *cancel_;
	std::uint64_t named_ = 0;
	Status refused_;
};

bool take_origin(ByteReader &r_bytes, StateHeader &r_header) {
	r_header.origin.name = r_bytes.take<std::uint64_t>();
	r_header.origin.end = take_count(r_bytes);
	const std::uint64_t span = r_header.is_complete ? r_header.origin.end : take_count(r_bytes);
	r_header.origin.base = r_header.origin.end - span;
	return r_bytes.good() && r_header.origin.name != 0 && span <= r_header.origin.end;
}

bool take_stamps(ByteReader &r_bytes, StateHeader &r_header) {
	const bool former = r_header.format == former_state_format;
	const auto last = former ? r_bytes.take<std::uint16_t>() : std::uint16_t{0};
	const std::uint64_t count = !former ? take_count(r_bytes) : last == no_layers ? 0 : std::uint64_t{last} + 1;
	for (std::uint64_t at = 0; at < count && r_bytes.good(); ++at) {
		const std::uint64_t layer = former ? r_bytes.take<std::uint16_t>() : take_count(r_bytes);
		if (layer > max_state_layer) {
			return false;
		}
		r_header.stamps[static_cast<std::uint16_t>(layer)] = r_bytes.take<std::uint64_t>();
	}
	return r_bytes.good() && r_header.stamps.size() == count;
}

/// Reads the header and removes it from the front.
Status take_header(ByteReader &r_bytes, StateHeader &r_header) {
	if (r_bytes.take<std::uint32_t>() != magic) {
		return corrupt;
	}
	r_header = {};
	r_header.format = r_bytes.take<std::uint32_t>();
	const bool former = r_header.format == former_state_format;
	if (r_bytes.good() && !former && r_header.format != state_format) {
		return Status::out_of_range(
				"version", r_header.format, between(former_state_format, state_format), newer_version);
	}
	const auto kind = r_bytes.take<std::uint8_t>();
	r_header.is_complete = (kind & partial_bit) == 0;
	r_header.time = take_time(r_bytes);
	const bool named = (kind & named_bit) != 0;
	const bool taken = kind <= (former ? partial_bit : partial_bit + named_bit) && is_time(r_header.time) &&
			(!named || take_origin(r_bytes, r_header)) && take_stamps(r_bytes, r_header);
	if (!taken) {
		return corrupt;
	}
	if (former) {
		r_header.sizes[StateHeader::removed] = ByteReader(r_bytes).take<std::uint32_t>();
		return {};
	}
	for (std::uint64_t &r_size : r_header.sizes) {
		r_size = take_count(r_bytes);
		if (!r_bytes.good() || r_size > 8 * r_bytes.rest().size()) {
			return corrupt; // A size above this limit is impossible, because each ID takes at least one bit.
		}
	}
	return {};
}

} // namespace

void write(const StateRecord &record, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel,
		std::uint32_t format) {
	r_bytes.clear();
	append(r_bytes, magic);
	append(r_bytes, format);
	RecordWriter(r_bytes, format, cancel).put(record);
	append(r_bytes, checksum(r_bytes));
}

Status read_header(std::span<const std::uint8_t> bytes, StateHeader &r_header) {
	return guarded("data", static_cast<double>(bytes.size()), [&] {
		ByteReader reader(bytes);
		return take_header(reader, r_header);
	});
}

Status read(std::span<const std::uint8_t> bytes, StateRecord &r_record, const DiffLimits &limits,
		const std::atomic<bool> *cancel) {
	return guarded("data", static_cast<double>(bytes.size()), [&]() -> Status {
		ByteReader reader(bytes);
		StateHeader header;
		if (const Status status = take_header(reader, header); !status.ok()) {
			return status;
		}
		if (const Status status =
						check_limit("changes", header.named(), limits.max_changes, "max_changes of diff_limits");
				!status.ok()) {
			return status;
		}
		if (header.is_complete && !limits.allow_replacement) {
			return refused_replacement();
		}
		const std::size_t rest = reader.rest().size();
		if (rest < checksum_size ||
				ByteReader(bytes.last(checksum_size)).take<std::uint64_t>() !=
						checksum(bytes.first(bytes.size() - checksum_size))) {
			return corrupt;
		}
		r_record = {};
		r_record.is_complete = header.is_complete;
		r_record.time = header.time;
		r_record.origin = header.origin;
		r_record.stamps = header.stamps;
		RecordReader record(ByteReader(reader.rest().first(rest - checksum_size)), header, limits, cancel);
		if (!record.take(r_record) || !is_consistent(r_record)) {
			return record.refused().ok() ? corrupt : record.refused();
		}
		std::vector<std::uint8_t> again;
		write(r_record, again, cancel, header.format);
		return std::ranges::equal(again, bytes) ? Status{} : corrupt;
	});
}

} // namespace thicket
