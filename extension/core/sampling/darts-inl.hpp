// Vector forms of the functions of dart.hpp, with bit-identical results. resolver.cpp compiles this
// file once for each instruction set.
#if defined(THICKET_DARTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_DARTS_INL
#undef THICKET_DARTS_INL
#else
#define THICKET_DARTS_INL
#endif

#include "core/sampling/level_grid.hpp"
#include "core/sampling/obstacle_grid.hpp"

#include <glm/common.hpp>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// True if Highway only emulates vectors. Steps that need only a few lanes are then processed lane
/// by lane.
constexpr bool is_scalar = HWY_TARGET == HWY_EMU128 || HWY_TARGET == HWY_SCALAR;

template <class D, class M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
	// Loads with the same width as the store, because a wider load would wait for the store.
	using Bits = std::conditional_t<(hn::MaxLanes(D()) > 8), std::uint16_t, std::uint8_t>;
	std::uint8_t bytes[8];
	hn::StoreMaskBits(d, mask, bytes);
	Bits bits;
	std::memcpy(&bits, bytes, sizeof(bits));
	return bits;
}

/// Converts the lowest bits of `bits` to a mask.
template <class D>
HWY_INLINE hn::Mask<D> mask_of(D d, std::uint32_t bits) {
	std::uint8_t bytes[8];
	std::memcpy(bytes, &bits, sizeof(bits));
	return hn::LoadMaskBits(d, bytes);
}

/// Compute the high and low halves of the 64-bit products of 32-bit lanes.
template <class V>
struct Product {
	V high;
	V low;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Product<V> multiply(D d, V a, std::uint32_t b) {
	const hn::RepartitionToWide<D> wide;
	const V factor = hn::Set(d, b);
	const auto even = hn::MulEven(a, factor);
	const auto odd = hn::MulEven(hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(wide, a))), factor);
	return {hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, hn::ShiftRight<32>(even))),
			hn::OddEven(hn::BitCast(d, hn::ShiftLeft<32>(odd)), hn::BitCast(d, even))};
}

/// Returns the first two words of philox4x32.
template <class V>
struct RandomBits {
	V first;
	V second;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE RandomBits<V> random_bits(D d, V c0, V c1, V c2, V c3, std::array<std::uint32_t, 2> key) {
	for (int round = 0; round < philox_rounds; ++round) {
		const Product<V> p0 = multiply(d, c0, philox_mul_0);
		const Product<V> p1 = multiply(d, c2, philox_mul_1);
		c0 = hn::Xor(hn::Xor(p1.high, c1), hn::Set(d, key[0]));
		c1 = p1.low;
		c2 = hn::Xor(hn::Xor(p0.high, c3), hn::Set(d, key[1]));
		c3 = p0.low;
		key[0] += philox_weyl_0;
		key[1] += philox_weyl_1;
	}
	return {c0, c1};
}

/// Performs `exponential` of dart.hpp with vectors, operation for operation. Multiplications and
/// additions are never fused.
template <class D, class V = hn::Vec<D>>
HWY_INLINE auto exponentials(D d, V random) {
	const hn::RebindToSigned<D> di;
	const hn::RebindToFloat<D> df;
	const auto odd = hn::ConvertTo(df, hn::BitCast(di, hn::Or(hn::ShiftRight<8>(random), hn::Set(d, 1u))));
	const auto shifted = hn::Add(hn::BitCast(d, odd), hn::Set(d, 0x00400000u));
	const auto exponent = hn::Sub(hn::Set(di, 127 + 24), hn::BitCast(di, hn::ShiftRight<23>(shifted)));
	const auto mantissa = hn::BitCast(df, hn::Add(hn::And(shifted, hn::Set(d, 0x007fffffu)), hn::Set(d, 0x3f400000u)));
	const auto one = hn::Set(df, 1.0f);
	const auto s = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one));
	const auto s2 = hn::Mul(s, s);
	const auto s4 = hn::Mul(s2, s2);
	const auto low = hn::Add(hn::Mul(s2, hn::Set(df, 1.0f / 3.0f)), one);
	const auto high = hn::Add(hn::Add(hn::Mul(s2, hn::Set(df, 1.0f / 7.0f)), hn::Set(df, 1.0f / 5.0f)),
			hn::Mul(s4, hn::Set(df, 1.0f / 9.0f)));
	const auto series = hn::Add(hn::Mul(high, s4), low);
	const auto ln_mantissa = hn::Mul(hn::Add(s, s), series);
	return hn::Sub(hn::Mul(hn::ConvertTo(df, exponent), hn::Set(df, 0.693147180559945f)), ln_mantissa);
}

/// The column part of the tags: the repeating sequence 0, 1, 2, 3, 4. A vector may start at any of
/// the first five entries.
constexpr auto column_tags = [] {
	std::array<std::uint32_t, 4 + hn::MaxLanes(hn::ScalableTag<std::uint32_t>())> tags{};
	for (std::uint32_t column = 0; column < tags.size(); ++column) {
		tags[column] = column % 5;
	}
	return tags;
}();

/// Throws the first darts of the cells [begin, end) of row `y`, except for cells that already have
/// one. The cells begin at `index` in the grid. They must not cross the border of a period, and their
/// coordinates must be those in the first period.
HWY_INLINE void throw_row(LevelGrid &grid, std::uint32_t index, std::int32_t y, std::int32_t begin, std::int32_t end) {
	const hn::ScalableTag<std::uint32_t> d;
	constexpr auto lanes = static_cast<std::int32_t>(hn::MaxLanes(d));
	const std::uint32_t row_tag = 5 * mod_5(y);
	if constexpr (is_scalar) {
		for (std::int32_t x = begin; x < end; ++x, ++index) {
			if (grid.time[index] == time_unthrown) {
				const DartKey dart = grid.source.base_dart(x, y);
				grid.time[index] = dart_time(dart);
				grid.dart[index] = dart_level_position(dart);
			}
		}
		return;
	}
	for (std::int32_t x = begin; x < end; x += lanes, index += static_cast<std::uint32_t>(lanes)) {
		const auto random =
				random_bits(d, hn::Iota(d, static_cast<std::uint32_t>(x)), hn::Set(d, static_cast<std::uint32_t>(y)),
						hn::Set(d, grid.source.stream), hn::Zero(d), grid.source.key);
		const auto time = hn::BitCast(d, exponentials(d, random.first));
		const auto tag = hn::Add(hn::LoadU(d, column_tags.data() + mod_5(x)), hn::Set(d, row_tag));
		const auto key = hn::Or(hn::And(time, hn::Set(d, ~tag_bits)), tag);
		const auto position = hn::And(random.second, hn::Set(d, position_mask));
		TimeKey *times = grid.time.data() + index;
		std::uint32_t *darts = grid.dart.data() + index;
		const auto before = hn::LoadU(d, times);
		const auto fresh = hn::And(hn::Eq(before, hn::Set(d, time_unthrown)),
				hn::FirstN(d, static_cast<std::size_t>(std::min(lanes, end - x))));
		hn::StoreU(hn::IfThenElse(fresh, key, before), d, times);
		hn::StoreU(hn::IfThenElse(fresh, position, hn::LoadU(d, darts)), d, darts);
	}
}

/// Throws the first darts of the cells [begin, end) of row `y`, except for cells that already have
/// one.
HWY_INLINE void throw_first_darts(LevelGrid &grid, std::int32_t y, std::int32_t begin, std::int32_t end) {
	const glm::ivec2 period = grid.source.period;
	grid.squares += static_cast<std::uint64_t>(end - begin);
	while (begin < end) {
		const std::int32_t first = wrapped(begin, period.x);
		const std::int32_t count = period.x == 0 ? end - begin : std::min(end - begin, period.x - first);
		throw_row(grid, grid.index_of({begin, y}), wrapped(y, period.y), first, first + count);
		begin += count;
	}
}

/// Closes the sub-squares that obstacles cover. Closed cells throw no dart.
inline void close_obstructed(LevelGrid &grid) {
	for (std::int32_t y = grid.cells.min.y; y < grid.cells.max.y; ++y) {
		const std::uint32_t first = grid.index_of({grid.cells.min.x, y});
		for (std::uint32_t cell = first; cell < first + static_cast<std::uint32_t>(grid.cells.size().x); ++cell) {
			grid.open[cell] = grid.obstacles->open(cell);
			grid.time[cell] = grid.open[cell] == 0 ? time_never : grid.time[cell];
		}
	}
}

/// Clears a grid and throws the first darts of its cells that lie in `wanted`. The times of border
/// cells stay unknown.
HWY_INLINE void start_grid(LevelGrid &grid, const CellRect &wanted) {
	const CellRect thrown{glm::max(wanted.min, grid.cells.min), glm::min(wanted.max, grid.cells.max)};
	const glm::ivec2 size = grid.cells.size() + 2 * LevelGrid::border;
	const std::size_t count = std::size_t{grid.stride} * static_cast<std::size_t>(size.y);
	std::fill_n(grid.time.begin(), count, time_unknown);
	std::fill_n(grid.point.begin(), count, LevelGrid::no_point);
	std::fill_n(grid.waiting.begin(), count, 0u);
	std::fill_n(grid.open.begin(), count, std::uint64_t{0});
	for (std::int32_t y = grid.cells.min.y; y < grid.cells.max.y; ++y) {
		const std::uint32_t index = grid.index_of({grid.cells.min.x, y});
		std::fill_n(grid.open.data() + index, grid.cells.size().x, LevelGrid::all_open);
		std::fill_n(grid.time.data() + index, grid.cells.size().x, time_unthrown);
	}
	if (grid.obstacles != nullptr) {
		close_obstructed(grid);
	}
	for (std::int32_t y = thrown.min.y; y < thrown.max.y; ++y) {
		throw_first_darts(grid, y, thrown.min.x, thrown.max.x);
	}
	grid.thrown = thrown;
}

/// Throws the first darts of all cells that do not have one yet.
HWY_NOINLINE void throw_all(LevelGrid &grid) {
	for (std::int32_t y = grid.cells.min.y; y < grid.cells.max.y; ++y) {
		if (grid.thrown.min.y <= y && y < grid.thrown.max.y) {
			throw_first_darts(grid, y, grid.cells.min.x, grid.thrown.min.x);
			throw_first_darts(grid, y, grid.thrown.max.x, grid.cells.max.x);
		} else {
			throw_first_darts(grid, y, grid.cells.min.x, grid.cells.max.x);
		}
	}
	grid.thrown = grid.cells;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
