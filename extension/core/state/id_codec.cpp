#include "core/state/id_codec.hpp"

#include "core/base/instance_id.hpp"
#include "core/base/progress.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>

namespace thicket {

namespace {

constexpr std::size_t block_size = 128;
/// Number of bits that store a block's parameter, or the width of a gap written in full.
constexpr int width_bits = 6;
constexpr std::uint64_t full_mark = 16; ///< This number of consecutive 1 bits marks a gap that is written in full.

constexpr std::uint64_t axis_mask = 0xffffff;

/// Inserts a 0 bit above each of the lowest 24 bits.
constexpr std::uint64_t spread(std::uint64_t bits) {
	bits = (bits | bits << 16) & 0x0000ffff0000ffff;
	bits = (bits | bits << 8) & 0x00ff00ff00ff00ff;
	bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0f;
	bits = (bits | bits << 2) & 0x3333333333333333;
	return (bits | bits << 1) & 0x5555555555555555;
}

/// Extracts the even bits: the inverse of `spread`.
constexpr std::uint64_t gather(std::uint64_t bits) {
	bits &= 0x5555555555555555;
	bits = (bits | bits >> 1) & 0x3333333333333333;
	bits = (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0f;
	bits = (bits | bits >> 4) & 0x00ff00ff00ff00ff;
	bits = (bits | bits >> 8) & 0x0000ffff0000ffff;
	return (bits | bits >> 16) & axis_mask;
}

/// Packs bits into bytes, lowest bit first.
class BitWriter {
public:
	explicit BitWriter(std::vector<std::uint8_t> &r_bytes) : bytes_(r_bytes) {}

	/// Appends the lowest `count` bits; `count` is 0 to 64. The higher bits must be 0.
	void put(std::uint64_t bits, int count) {
		pending_ |= bits << pending_count_;
		const int free_bits = 64 - pending_count_;
		if (count < free_bits) {
			pending_count_ += count;
			return;
		}
		append(bytes_, pending_);
		pending_ = free_bits < 64 ? bits >> free_bits : 0;
		pending_count_ = count - free_bits;
	}

	/// Writes the remaining bits and pads the last byte with zeros.
	void finish() {
		for (; pending_count_ > 0; pending_count_ -= 8, pending_ >>= 8) {
			bytes_.push_back(static_cast<std::uint8_t>(pending_));
		}
	}

private:
	std::vector<std::uint8_t> &bytes_;
	std::uint64_t pending_ = 0;
	int pending_count_ = 0; ///< Number of bits in `pending_`, 0 to 63.
};

/// Reads bits from bytes in the order in which BitWriter wrote them. Past the end, all bits are 0.
class BitReader {
public:
	explicit BitReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

	std::uint64_t take(int count) {
		std::uint64_t bits = 0;
		for (int got = 0; got < count;) {
			const std::size_t byte = position_ / 8;
			const auto offset = static_cast<int>(position_ % 8);
			const int now = std::min(8 - offset, count - got);
			const std::uint64_t piece = byte < bytes_.size() ? bytes_[byte] >> offset : 0;
			bits |= (piece & ((1U << now) - 1)) << got;
			got += now;
			position_ += static_cast<std::size_t>(now);
		}
		return bits;
	}

	/// Reads 1 bits until the first 0 bit, which is consumed, or until `max_count` of them were
	/// read. Returns their number.
	std::uint64_t take_ones(std::uint64_t max_count) {
		std::uint64_t ones = 0;
		while (ones < max_count && take(1) == 1) {
			++ones;
		}
		return ones;
	}

	bool good() const { return position_ <= 8 * bytes_.size(); }
	std::size_t bytes_taken() const { return (position_ + 7) / 8; }

private:
	std::span<const std::uint8_t> bytes_;
	std::size_t position_ = 0; ///< Position of the next bit.
};

std::uint64_t cost(std::span<const std::uint64_t> gaps, int parameter) {
	std::uint64_t bits = 0;
	for (const std::uint64_t gap : gaps) {
		const std::uint64_t ones = gap >> parameter;
		const int rest = ones < full_mark ? parameter + 1 : width_bits + static_cast<int>(std::bit_width(gap));
		bits += std::min(ones, full_mark) + static_cast<std::uint64_t>(rest);
	}
	return bits;
}

/// Returns the parameter near the median gap with the shortest encoding. The mean is unsuitable,
/// because a few wide gaps between groups dominate it.
int best_parameter(std::span<const std::uint64_t> gaps) {
	std::array<std::uint64_t, block_size> sorted{};
	std::ranges::copy(gaps, sorted.begin());
	const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
	std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(gaps.size()));
	const auto about = static_cast<int>(std::bit_width(*middle));
	int best = 0;
	std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
	for (int parameter = std::max(about - 3, 0); parameter <= std::min(about + 2, 63); ++parameter) {
		if (const std::uint64_t bits = cost(gaps, parameter); bits < least) {
			least = bits;
			best = parameter;
		}
	}
	return best;
}

void put_gap(std::uint64_t gap, int parameter, BitWriter &r_bits) {
	const std::uint64_t ones = gap >> parameter;
	if (ones < full_mark) {
		r_bits.put((std::uint64_t{1} << ones) - 1, static_cast<int>(ones) + 1);
		r_bits.put(gap & ((std::uint64_t{1} << parameter) - 1), parameter);
		return;
	}
	const auto width = static_cast<int>(std::bit_width(gap));
	r_bits.put((std::uint64_t{1} << full_mark) - 1, static_cast<int>(full_mark));
	r_bits.put(static_cast<std::uint64_t>(width - 1), width_bits);
	r_bits.put(gap, width);
}

std::uint64_t take_gap(int parameter, BitReader &r_bits) {
	const std::uint64_t ones = r_bits.take_ones(full_mark);
	if (ones < full_mark) {
		return ones << parameter | r_bits.take(parameter);
	}
	const auto width = static_cast<int>(r_bits.take(width_bits)) + 1;
	return r_bits.take(width);
}

} // namespace

std::uint64_t code_of(std::uint64_t id) {
	return (id & ~id_cell_mask) | spread(id >> 24 & axis_mask) << 1 | spread(id & axis_mask);
}

std::uint64_t id_of(std::uint64_t code) {
	const std::uint64_t cell = code & id_cell_mask;
	return (code & ~id_cell_mask) | gather(cell >> 1) << 24 | gather(cell);
}

void append_ascending(
		std::span<const std::uint64_t> numbers, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel) {
	BitWriter bits(r_bytes);
	std::array<std::uint64_t, block_size> gaps{};
	std::uint64_t next = 0; // The smallest value that the next number can have.
	for (std::size_t start = 0; start < numbers.size() && !is_cancelled(cancel); start += block_size) {
		const std::span<const std::uint64_t> block =
				numbers.subspan(start, std::min(block_size, numbers.size() - start));
		for (std::size_t at = 0; at < block.size(); ++at) {
			gaps[at] = block[at] - next;
			next = block[at] + 1;
		}
		const int parameter = best_parameter({gaps.data(), block.size()});
		bits.put(static_cast<std::uint64_t>(parameter), width_bits);
		for (std::size_t at = 0; at < block.size(); ++at) {
			put_gap(gaps[at], parameter, bits);
		}
	}
	bits.finish();
}

bool take_ascending(ByteReader &r_bytes, std::size_t count, std::vector<std::uint64_t> &r_numbers,
		const std::atomic<bool> *cancel) {
	// A count above 8 per byte is an error, because each number takes at least one bit.
	if (!r_bytes.good() || count > 8 * r_bytes.rest().size()) {
		return false;
	}
	r_numbers.clear();
	r_numbers.reserve(count);
	BitReader bits(r_bytes.rest());
	std::uint64_t next = 0;
	int parameter = 0;
	for (std::size_t at = 0; at < count; ++at) {
		if (at % block_size == 0) {
			if (is_cancelled(cancel)) {
				return false;
			}
			parameter = static_cast<int>(bits.take(width_bits));
		}
		const std::uint64_t gap = take_gap(parameter, bits);
		if (!bits.good() || gap >= std::numeric_limits<std::uint64_t>::max() - next) {
			return false;
		}
		r_numbers.push_back(next + gap);
		next += gap + 1;
	}
	r_bytes.take_bytes(bits.bytes_taken());
	return true;
}

} // namespace thicket
