function h5write(file, dataset, data)
  run_hdf5('write', file, dataset, data);
end
