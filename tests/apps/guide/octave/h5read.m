function data = h5read(file, dataset)
  data = run_hdf5('read', file, dataset, []);
end
