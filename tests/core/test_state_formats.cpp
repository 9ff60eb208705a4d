// Tests that states and diffs of release 0.2.0 load, that the current format is small, and that its
// diffs are ordered.

#include "core/state/diff_summary.hpp"
#include "core/state/state_format.hpp"
#include "state_fixture.hpp"

#include <string_view>

using namespace thicket;

namespace {

/// The output of release 0.2.0: a state with every kind of content, and a diff of five later
/// changes.
constexpr std::string_view former_state = "545354410100000000000000000000044003000100efcdab9078563412020000000000000000"
										  "00030000000000000000000400000000000000"
										  "000006000000ee87abaaaaaaaa0a0000000000aaaaaaaaaaaa0400000000000a00000000803b"
										  "ffdfb2ca540101000000c10200000000000059"
										  "4001000000710000000000c0010000000001000000fe24fbd0d64c43090002000000000000f8"
										  "3f000000000000084000000000000004c00000"
										  "803f0000803e00000000000000000000803f0000000000000000000000000000803f03000000"
										  "701000000000c0bdffffffffffffffff917d68"
										  "6ba6e10080020000000102010000000303000000040506d1ac201105112b4b";
constexpr std::string_view former_diff = "5453544101000000010000000000000c4002000100efcdab90785634120300000000000000000"
										 "0040000000000000000000100000070c30000"
										 "0000c0000000000200000070b8aaaaaaaa6a3baaaaaaaaaa0201000000fe24fbd0d64c4309000"
										 "1000000fe364ce464687e0900020000000000"
										 "001c40000000000000084000000000000004c00000803f0000803e00000000000000000000803"
										 "f0000000000000000000000000000803f0000"
										 "0000da09cd30a2abd62f";
constexpr std::uint64_t first_oak = 0x8004cd76691298f4;
constexpr std::uint64_t second_oak = 0x8004f45553764c25;
constexpr std::uint64_t digest_before = 0x5391df59f234f80b;
constexpr std::uint64_t digest_after = 0xf910788a1adff848;

StateBytes bytes_from(std::string_view hex) {
	const auto digit = [](char letter) {
		return letter <= '9' ? letter - '0' : letter - 'a' + 10;
	};
	StateBytes bytes;
	for (std::size_t at = 0; at + 1 < hex.size(); at += 2) {
		bytes.push_back(static_cast<std::uint8_t>(16 * digit(hex[at]) + digit(hex[at + 1])));
	}
	return bytes;
}

} // namespace

TEST_CASE("state formats: a state and a diff of release 0.2.0 load with the same content") {
	InstanceState state;
	std::vector<InstanceChange> changes;
	REQUIRE(state.load(bytes_from(former_state), changes).ok());
	CHECK(state.digest() == digest_before);
	CHECK(state.removed_ids(1).size() == 5);
	CHECK(state.stamp(1) == 0x1234567890abcdef);
	CHECK(state.time() == 2.5);
	REQUIRE(state.added(first_oak) != nullptr);
	CHECK(state.added(first_oak)->position == glm::dvec3(1.5, 3.0, -2.5));
	CHECK(state.data(first_oak).size() == 3);
	REQUIRE(state.apply(bytes_from(former_diff), changes).ok());
	CHECK(state.digest() == digest_after);
	CHECK(state.added(first_oak) == nullptr);
	CHECK(state.added(second_oak)->position.x == 7.0);
	CHECK(state.time() == 3.5);
	// Applying the diff again has no effect. The state is saved in the current format.
	changes.clear();
	REQUIRE(state.apply(bytes_from(former_diff), changes).ok());
	CHECK(changes.empty());
	CHECK(bytes_of(state)[4] == state_format);
	CHECK(copy_of(state).digest() == digest_after);
}

TEST_CASE("state formats: damaged bytes of release 0.2.0 are rejected, and loaded ones can be saved") {
	for (const std::string_view hex : {former_state, former_diff}) {
		const StateBytes all_bytes = bytes_from(hex);
		StateRecord record;
		REQUIRE(read(all_bytes, record).ok());
		StateBytes saved_again;
		write(record, saved_again, nullptr, former_state_format);
		CHECK(saved_again == all_bytes);
		for (std::size_t at = 0; at < all_bytes.size() - 8; ++at) {
			for (const int bit : {1, 16, 128}) {
				StateBytes bytes = all_bytes;
				bytes[at] ^= static_cast<std::uint8_t>(bit);
				CHECK_FALSE(read(bytes, record).ok());
				bytes = with_checksum(bytes);
				if (read(bytes, record).ok()) {
					write(record, saved_again, nullptr, record.origin.name != 0 ? state_format : former_state_format);
					CHECK(saved_again == bytes);
				}
			}
		}
	}
}

TEST_CASE("state formats: the diff of a single removal is small for a named state") {
	InstanceState server;
	server.set_origin(0x0123456789abcdef);
	REQUIRE(server.claim(1, 0x1234567890abcdef).ok());
	for (int i = 0; i < 1000; ++i) {
		server.remove(point_id(1, i * 37 % 200, i * 91 % 200));
	}
	const std::uint64_t known_revision = server.revision();
	server.remove(point_id(1, 55, 555));
	CHECK(diff_of(server, known_revision).size() <=
			60); // Release 0.2.0 needs 68 bytes, without the sender and the order.
	const std::size_t byte_count = diff_of(server, 0).size();
	CHECK(byte_count < 3 * server.removed_count());
	CHECK(byte_count <= 315); // Release 0.2.0 needs 318 bytes.
}

TEST_CASE("state formats: the header of a diff names its sender and its range of changes") {
	InstanceState server;
	server.set_origin(77);
	server.remove(point_id(1, 1, 1));
	server.remove(point_id(1, 2, 2));
	StateHeader header;
	REQUIRE(read_header(diff_of(server, 1), header).ok());
	CHECK(header.origin == StateOrigin{77, 1, 2});
	CHECK_FALSE(header.is_complete);
	CHECK(header.named() == 1);
	REQUIRE(read_header(diff_of(server, 9), header).ok());
	CHECK(header.origin == StateOrigin{77, 0, 2});
	CHECK(header.is_complete);
	StateBytes bytes;
	const std::uint64_t ids[] = {point_id(1, 1, 1)};
	REQUIRE(server.diff_of(ids, bytes).ok());
	REQUIRE(read_header(bytes, header).ok());
	CHECK(header.origin == StateOrigin());
	REQUIRE(server.diff_since(1, bytes, false).ok());
	REQUIRE(read_header(bytes, header).ok());
	CHECK(header.origin == StateOrigin());
	REQUIRE(read_header(bytes_of(server), header).ok());
	CHECK(header.origin == StateOrigin());
}
