sunfleck_technique(transfer
  SOURCES transfer_data.cpp transfer_cache.cpp environment_probe.cpp transfer_lighting.cpp
          transfer_pass.cpp transfer_technique.cpp
  SHADERS transfer.vert transfer.frag)
