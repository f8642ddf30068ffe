// Where an edge runs through a pixel, as the 8 bits of an alpha channel: what anti-aliasing finds, and the enlargement
// to twice the size draws. Bits 0 and 1: side of the pixel where the edge is; 2 to 4 and 5 to 7: share of the first and
// of the second quarter of the pixel on that side (left to right, or down) that the neighbour over the edge covers, in
// sevenths. 0: there is no edge.

const uint edge_at_left = 0u, edge_at_right = 1u, edge_at_top = 2u, edge_at_bottom = 3u;

// As a value of the channel, 0 to 1. An edge that covers nothing is told from none by a side that is not 0.
float edge_code(bool at_far_side, bool runs_down, vec2 covered) {
    const uint first = uint(covered.x * 7.0 + 0.5), second = uint(covered.y * 7.0 + 0.5);
    const uint side = (runs_down ? edge_at_left : edge_at_top) + (at_far_side ? 1u : 0u);
    const uint shown = (first | second) == 0u ? edge_at_bottom : side;
    return float(shown | first << 2u | second << 5u) / 255.0;
}

uint edge_bits(float alpha) {
    return uint(alpha * 255.0 + 0.5);
}
uint edge_side(uint bits) {
    return bits & 3u;
}
float edge_share(uint bits, bool second) {
    return float((second ? bits >> 5u : bits >> 2u) & 7u) / 7.0;
}
