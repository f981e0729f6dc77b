function h5writeatt(file, dataset, name, data)
  run_hdf5('attribute', file, [dataset ' ' name], data);
end
