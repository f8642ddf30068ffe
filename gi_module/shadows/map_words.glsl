// Shadow maps as kernels read them: as words of 32 bits, of which one holds two texels of 16 bits. A CPU device gathers
// words for all lanes at once, and smaller texels one by one. The including shader first defines map_bits.

int map_word(int place) { return map_bits == 16u ? place >> 1 : place; }

// The value of the texel at `place` from its word.
float value_in_word(uint word, int place) {
    if (map_bits == 32u)
        return uintBitsToFloat(word);
    return float((place & 1) != 0 ? word >> 16 : word & 0xffffu) * (1.0 / 65535.0);
}
