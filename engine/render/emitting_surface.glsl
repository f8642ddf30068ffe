// Which surface that emits a sample shows, as a value of 8 bits: 0 is none. They may share a plane with what they are
// set into, and are far brighter. Rows that have one number are not told apart.
float emitting_surface(uint surface) {
    return (surface & surface_emits) == 0u ? 0.0 : float(1u + surface_row(surface) % 255u) / 255.0;
}
