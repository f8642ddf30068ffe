// Jobs of light maps, from a texel buffer. A CPU device reads a job for each of its lanes, from a storage buffer number
// by number. The including shader first declares the buffer `jobs`.

LightMapJob job_at(uint number) {
    const int first = int(number) * 8;
    const uvec4 surface = texelFetch(jobs, first + 5), map = texelFetch(jobs, first + 6), work = texelFetch(jobs, first + 7);
    return LightMapJob(uintBitsToFloat(texelFetch(jobs, first)), uintBitsToFloat(texelFetch(jobs, first + 1)),
                       uintBitsToFloat(texelFetch(jobs, first + 2)), uintBitsToFloat(texelFetch(jobs, first + 3)),
                       uintBitsToFloat(texelFetch(jobs, first + 4)), surface.x, uintBitsToFloat(surface.y),
                       uint[2](surface.z, surface.w), map.x, map.y, map.z, map.w, work.x, work.y, work.z, work.w);
}
