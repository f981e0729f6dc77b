function h5create(file, dataset, extents)
  run_hdf5('create', file, dataset, extents);
end
