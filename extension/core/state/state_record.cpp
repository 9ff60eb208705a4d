#include "core/state/state_record.hpp"

#include "core/base/bytes.hpp"
#include "core/base/check.hpp"
#include "core/base/guard.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

// Format 1, all numbers little-endian; a list is written as id_codec.hpp says, ids in it are codes:
//   "TSTA", u32 version, u8 kind: 0 for a whole state, 1 for some ids, f64 clock in seconds;
//   u16 number of layers less 1, or 0xffff for none; for each, ascending: u16 layer, u64 stamp;
//   list of removed points, list of the indices in it of those that grow again, f64 time of each of these;
//   list of points that are not removed, list of hand-placed ids that are gone;
//   list of hand-placed ids; for each: u8 mesh, 3 f64 position, 9 f32 basis, column by column;
//   list of ids with data; for each: u32 size, its bytes;
//   u64 FNV-1a of all bytes before it.
// One content has one such form. Nothing else is taken, so what was taken is written again to the byte.

namespace thicket {

namespace {

constexpr std::uint32_t magic = 0x41545354;
constexpr std::uint32_t format_version = 1;
constexpr std::size_t checksum_size = 8;
constexpr std::uint16_t no_layers = 0xffff;
constexpr std::size_t instance_size = 1 + 3 * 8 + 9 * 4;
constexpr std::size_t least_data_size = 4 + 1;

constexpr Status corrupt{ErrorCode::corrupt, "data"};

/// Calls `use` for each number of an instance that may have a sign.
template <typename Instance, typename Use>
void for_each_number(Instance &instance, Use use) {
	for (int axis = 0; axis < 3; ++axis) {
		use(instance.position[axis]);
	}
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			use(instance.basis[column][row]);
		}
	}
}

void append_time(double time, std::vector<std::uint8_t> &r_bytes) {
	append(r_bytes, std::bit_cast<std::uint64_t>(time));
}

double take_time(ByteReader &r_bytes) { return std::bit_cast<double>(r_bytes.take<std::uint64_t>()); }

void append_instance(const AddedInstance &instance, std::vector<std::uint8_t> &r_bytes) {
	append(r_bytes, instance.mesh);
	for_each_number(instance, [&r_bytes](auto number) {
		if constexpr (sizeof number == 8) {
			append(r_bytes, std::bit_cast<std::uint64_t>(number));
		} else {
			append(r_bytes, std::bit_cast<std::uint32_t>(number));
		}
	});
}

/// False if there is none as `append_instance` writes it.
bool take_instance(ByteReader &r_bytes, AddedInstance &r_instance) {
	r_instance.mesh = r_bytes.take<std::uint8_t>();
	bool signed_zero = false;
	for_each_number(r_instance, [&r_bytes, &signed_zero](auto &r_number) {
		if constexpr (sizeof r_number == 8) {
			r_number = std::bit_cast<double>(r_bytes.take<std::uint64_t>());
		} else {
			r_number = std::bit_cast<float>(r_bytes.take<std::uint32_t>());
		}
		signed_zero = signed_zero || (r_number == 0 && std::signbit(r_number));
	});
	return r_bytes.good() && !signed_zero && validate(r_instance).ok();
}

void append_data(const std::vector<std::uint8_t> &data, std::vector<std::uint8_t> &r_bytes) {
	append(r_bytes, static_cast<std::uint32_t>(data.size()));
	r_bytes.insert(r_bytes.end(), data.begin(), data.end());
}

/// False if there are none as `append_data` writes them.
bool take_data(ByteReader &r_bytes, std::vector<std::uint8_t> &r_data) {
	const auto size = r_bytes.take<std::uint32_t>();
	if (size == 0 || size > max_instance_data) {
		return false;
	}
	const std::span<const std::uint8_t> bytes = r_bytes.take_bytes(size);
	r_data.assign(bytes.begin(), bytes.end());
	return r_bytes.good();
}

bool is_time(double time) { return check_range("time", time, 0.0, max_state_time).ok() && !std::signbit(time); }

bool take_stamps(ByteReader &r_bytes, StateRecord &r_record) {
	const auto last = r_bytes.take<std::uint16_t>();
	const std::size_t count = last == no_layers ? 0 : std::size_t{last} + 1;
	for (std::size_t at = 0; at < count && r_bytes.good(); ++at) {
		const auto layer = r_bytes.take<std::uint16_t>();
		r_record.stamps[layer] = r_bytes.take<std::uint64_t>();
	}
	return r_bytes.good() && r_record.stamps.size() == count;
}

bool take_removed(ByteReader &r_bytes, StateRecord &r_record, const std::atomic<bool> *cancel) {
	std::vector<std::uint64_t> timed;
	if (!take_ascending(r_bytes, r_record.removed, cancel) || !take_ascending(r_bytes, timed) ||
			(!timed.empty() && timed.back() >= r_record.removed.size())) {
		return false;
	}
	for (const std::uint64_t index : timed) {
		const double time = take_time(r_bytes);
		if (!r_bytes.good() || !is_time(time) || time == 0.0) {
			return false;
		}
		r_record.until.emplace_back(index, time);
	}
	return true;
}

bool take_added(ByteReader &r_bytes, StateRecord &r_record) {
	if (!take_ascending(r_bytes, r_record.added) || r_record.added.size() > r_bytes.rest().size() / instance_size) {
		return false;
	}
	r_record.instances.resize(r_record.added.size());
	for (std::size_t at = 0; at < r_record.added.size(); ++at) {
		r_record.instances[at].layer = layer_of(r_record.added[at]);
		if (!take_instance(r_bytes, r_record.instances[at])) {
			return false;
		}
	}
	return true;
}

bool take_all_data(ByteReader &r_bytes, StateRecord &r_record) {
	if (!take_ascending(r_bytes, r_record.with_data) ||
			r_record.with_data.size() > r_bytes.rest().size() / least_data_size) {
		return false;
	}
	r_record.data.resize(r_record.with_data.size());
	return std::ranges::all_of(
			r_record.data, [&r_bytes](std::vector<std::uint8_t> &r_data) { return take_data(r_bytes, r_data); });
}

bool are_points(const StateRecord::Codes &codes) { return codes.empty() || !is_added(codes.back()); }

bool are_added(const StateRecord::Codes &codes) { return codes.empty() || is_added(codes.front()); }

/// Whether each of `part` is in one of `lists`.
bool covers(const std::array<const StateRecord::Codes *, 3> &lists, const StateRecord::Codes &part) {
	return std::ranges::all_of(part, [&lists](std::uint64_t code) {
		return std::ranges::any_of(
				lists, [code](const StateRecord::Codes *list) { return std::ranges::binary_search(*list, code); });
	});
}

bool disjoint(const StateRecord::Codes &left, const StateRecord::Codes &right) {
	return std::ranges::none_of(left, [&right](std::uint64_t code) { return std::ranges::binary_search(right, code); });
}

/// Whether the lists say one thing of each id, and nothing twice.
bool consistent(const StateRecord &record) {
	const bool kinds = are_points(record.removed) && are_points(record.standing) && are_added(record.gone) &&
			are_added(record.added);
	const bool once = disjoint(record.standing, record.removed) && disjoint(record.gone, record.added);
	const bool no_more_than_whole = !record.whole ||
			(record.gone.empty() && covers({&record.with_data, &record.with_data, &record.with_data}, record.standing));
	return kinds && once && no_more_than_whole &&
			covers({&record.removed, &record.standing, &record.added}, record.with_data);
}

bool take_record(ByteReader bytes, StateRecord &r_record, const std::atomic<bool> *cancel) {
	const auto kind = bytes.take<std::uint8_t>();
	r_record = {};
	r_record.whole = kind == 0;
	r_record.time = take_time(bytes);
	const bool taken = kind <= 1 && is_time(r_record.time) && take_stamps(bytes, r_record) &&
			take_removed(bytes, r_record, cancel) && take_ascending(bytes, r_record.standing, cancel) &&
			take_ascending(bytes, r_record.gone) && take_added(bytes, r_record) && take_all_data(bytes, r_record);
	if (!taken || !bytes.at_end() || !consistent(r_record)) {
		return false;
	}
	const std::map<std::uint16_t, std::uint64_t> layers = r_record.layers();
	return std::ranges::equal(
			layers, r_record.stamps, {}, [](const auto &a) { return a.first; }, [](const auto &b) { return b.first; });
}

} // namespace

Status validate(const AddedInstance &instance) {
	if (instance.layer > max_state_layer) {
		return Status::out_of_range("layer", instance.layer, at_most(max_state_layer));
	}
	for (int axis = 0; axis < 3; ++axis) {
		if (const Status status =
						check_range("position", instance.position[axis], -max_added_coordinate, max_added_coordinate);
				!status.ok()) {
			return status;
		}
	}
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			if (const double number = instance.basis[column][row]; !std::isfinite(number)) {
				return {ErrorCode::not_finite, "basis", number};
			}
		}
	}
	return {};
}

AddedInstance without_signed_zeros(AddedInstance instance) {
	for_each_number(instance, [](auto &r_number) {
		if (r_number == 0) {
			r_number = 0;
		}
	});
	return instance;
}

std::map<std::uint16_t, std::uint64_t> StateRecord::layers() const {
	std::map<std::uint16_t, std::uint64_t> found;
	for (const Codes *codes : {&removed, &standing, &gone, &added}) {
		int last = -1;
		for (const std::uint64_t code : *codes) {
			if (layer_of(code) != last) {
				last = layer_of(code);
				found.emplace(layer_of(code), 0);
			}
		}
	}
	return found;
}

bool StateRecord::holds_points(std::uint16_t layer) const {
	return std::ranges::any_of(std::array{&removed, &standing}, [layer](const Codes *codes) {
		const auto first = std::ranges::lower_bound(*codes, layer, {}, layer_of);
		return first != codes->end() && layer_of(*first) == layer;
	});
}

bool StateRecord::names(std::uint64_t id) const {
	const std::uint64_t code = code_of(id);
	return std::ranges::any_of(std::array{&removed, &standing, &gone, &added},
			[code](const Codes *codes) { return std::ranges::binary_search(*codes, code); });
}

std::span<const std::uint8_t> StateRecord::data_of(std::uint64_t code) const {
	const auto found = std::ranges::lower_bound(with_data, code);
	if (found == with_data.end() || *found != code) {
		return {};
	}
	return data[static_cast<std::size_t>(found - with_data.begin())];
}

void write(const StateRecord &record, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel) {
	r_bytes.clear();
	append(r_bytes, magic);
	append(r_bytes, format_version);
	append(r_bytes, static_cast<std::uint8_t>(record.whole ? 0 : 1));
	append_time(record.time, r_bytes);
	append(r_bytes, static_cast<std::uint16_t>(record.stamps.size() - 1));
	for (const auto &[layer, stamp] : record.stamps) {
		append(r_bytes, layer);
		append(r_bytes, stamp);
	}
	append_ascending(record.removed, r_bytes, cancel);
	std::vector<std::uint64_t> timed;
	for (const auto &[index, time] : record.until) {
		timed.push_back(index);
	}
	append_ascending(timed, r_bytes);
	for (const auto &[index, time] : record.until) {
		append_time(time, r_bytes);
	}
	append_ascending(record.standing, r_bytes, cancel);
	append_ascending(record.gone, r_bytes);
	append_ascending(record.added, r_bytes);
	for (const AddedInstance &instance : record.instances) {
		append_instance(instance, r_bytes);
	}
	append_ascending(record.with_data, r_bytes);
	for (const std::vector<std::uint8_t> &data : record.data) {
		append_data(data, r_bytes);
	}
	append(r_bytes, checksum(r_bytes));
}

Status read(std::span<const std::uint8_t> bytes, StateRecord &r_record, const std::atomic<bool> *cancel) {
	ByteReader reader(bytes);
	if (reader.take<std::uint32_t>() != magic) {
		return corrupt;
	}
	if (const auto version = reader.take<std::uint32_t>(); reader.good() && version != format_version) {
		return Status::out_of_range("version", version, exactly(format_version), newer_version);
	}
	if (!reader.good() || reader.rest().size() < checksum_size) {
		return corrupt;
	}
	if (ByteReader(bytes.last(checksum_size)).take<std::uint64_t>() !=
			checksum(bytes.first(bytes.size() - checksum_size))) {
		return corrupt;
	}
	return guarded("data", static_cast<double>(bytes.size()), [&]() -> Status {
		if (!take_record(ByteReader(reader.rest().first(reader.rest().size() - checksum_size)), r_record, cancel)) {
			return corrupt;
		}
		std::vector<std::uint8_t> again;
		write(r_record, again, cancel);
		return std::ranges::equal(again, bytes) ? Status{} : corrupt;
	});
}

} // namespace thicket
